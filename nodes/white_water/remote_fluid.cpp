#include "nodes/white_water/remote_fluid.h"

#include <algorithm>
#include <cmath>

#include "framework/base/error.h"
#include "framework/compute/dispatch.h"

namespace weir {

RemoteFluid::~RemoteFluid() {
  try {
    release();
  } catch (const Error&) {  // of the device, which whoever uses it next is told of
  }
}

void RemoteFluid::Layers::extend(const Layers& o) {
  if (o.empty()) return;
  *this = empty() ? o : Layers{std::min(first, o.first), std::max(last, o.last)};
}

RemoteFluid::Ask RemoteFluid::askOf(const Aabb& box, const Slabs& slabs, float reach) const {
  Ask ask;
  const CellLayers slab = slabs.layersOf(ranks_.rank());
  if (!box.empty()) ask.has = {slabs.layers.layerOf(box.lo), slabs.layers.layerOf(box.hi)};
  ask.wants = ask.has;
  ask.wants.extend({slab.first, slab.first + slab.count - 1});
  if (ask.wants.empty()) return ask;
  // Layers are found in floats, so far from the origin two of them may seem a bit nearer than they are.
  constexpr float kRounding = 0.05f;
  const int beside = static_cast<int>(std::ceil(reach * slabs.layers.inverseCellSize + kRounding));
  ask.wants = {ask.wants.first - beside, ask.wants.last + beside};
  return ask;
}

void RemoteFluid::fetch(const Particles& own, const Aabb& box, const Slabs& slabs, float reach) {
  release();
  const std::vector<Ask> asks = ranks_.allGather(askOf(box, slabs, reach));
  const int self = ranks_.rank();
  const Ask& mine = asks[std::size_t(self)];
  for (int to = 0; to < ranks_.size(); ++to)
    if (const Layers& wanted = asks[std::size_t(to)].wants; to != self && mine.has.meet(wanted))
      ranks_.postParcel(to, packed(own, slabs.layers, wanted));
  std::vector<int> seen;
  for (int from = 0; from < ranks_.size(); ++from)
    if (from != self && asks[std::size_t(from)].has.meet(mine.wants)) seen.push_back(from);
  parcels_ = ranks_.receiveParcels(seen, own.set().device());
  take();
}

Parcel RemoteFluid::packed(const Particles& own, const CellLayers& layers, const Layers& wanted) {
  Device& device = own.set().device();
  const std::int64_t count =
      dispatch(device, [&](auto& backend) { return findWantedOn(backend, own, layers, wanted); });
  Array<std::byte> bytes(device, count * std::int64_t{sizeof(FluidPoint)});
  dispatch(device, [&](auto& backend) {
    packOn(backend, own, {reinterpret_cast<FluidPoint*>(bytes.data()), count});
  });
  return Parcel(std::move(bytes));
}

/// In the order of ranks, which does not matter.
void RemoteFluid::take() {
  std::int64_t bytes = 0;
  for (const Parcel& parcel : parcels_) bytes += parcel.size();
  points_.resizeDiscarding(bytes / std::int64_t{sizeof(FluidPoint)});
  auto* to = reinterpret_cast<std::byte*>(points_.data());
  for (const Parcel& parcel : parcels_) {
    parcel.copyTo(points_.device(), to);
    to += parcel.size();
  }
}

/// Gives the memory of all parcels back to their senders.
void RemoteFluid::release() {
  if (parcels_.empty()) return;
  points_.device().synchronize();
  parcels_.clear();
}

}  // namespace weir
