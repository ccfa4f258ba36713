#include "plugins/views/shown_particles.h"

#include <utility>

#include "framework/compute/dispatch.h"

namespace weir::rendering {

namespace {

template <class T>
std::span<const T> spanOf(ArrayView<const T> view) {
  return {view.data, static_cast<std::size_t>(view.size)};
}

}  // namespace

std::vector<Cut> cutsOf(const GroupList<ClipSettings>& clips) {
  std::vector<Cut> cuts;
  for (std::size_t i = 0; i < clips.size(); ++i) {
    const auto& thickness = clips[i].thickness.get();
    cuts.push_back({clips[i].point, normalized(clips[i].normal.get()), thickness ? 0.5f * *thickness : -1});
  }
  return cuts;
}

bool isShown(std::span<const Cut> cuts, const Vec3f& place) {
  for (const Cut& cut : cuts)
    if (!cut.shows(place)) return false;
  return true;
}

ArrayView<float> ShownParticles::roomForValues(std::int64_t count) {
  made_.resizeDiscarding(count);
  return made_.view();
}

void ShownParticles::load(FluidSnapshot& fluid, const std::optional<Vec2f>& foamEnds) {
  positions_ = fluid.positions.on(device_, positionRoom_);
  velocities_ = {};
  if (fluid.velocities.size() > 0) velocities_ = fluid.velocities.on(device_, velocityRoom_);
  values_ = {};
  kinds_ = {};
  isWhite_ = fluid.white;
  if (!fluid.colorType) return;
  if (fluid.white) return loadRadii(fluid);
  dispatch(device_, [&](auto& device) {
    withAttributeType(*fluid.colorType, [&]<class T>(std::type_identity<T>) {
      const ArrayView<const T> elements = fluid.numbers<T>().on(device, std::get<Array<T>>(numberRooms_));
      if constexpr (std::is_same_v<T, float>) {
        values_ = elements;
      } else {
        findNumbers(device, elements, roomForValues(elements.size));
        values_ = made_.view();
      }
    });
    if (!foamEnds) return;
    findParts(device, values_, *foamEnds, roomForValues(values_.size));
    values_ = made_.view();
  });
}

void ShownParticles::loadRadii(FluidSnapshot& fluid) {
  const auto on = [&]<class T>(FrameElements<T>& numbers) {
    return numbers.on(device_, std::get<Array<T>>(numberRooms_));
  };
  dispatch(device_, [&](auto& device) {
    const ArrayView<const float> stored = on(fluid.numbers<float>());
    if (fluid.kinds) kinds_ = on(fluid.numbers<int>());
    findWhiteRadii(device, stored, kinds_, 0.5f * fluid.spacing, roomForValues(stored.size));
    values_ = made_.view();
  });
}

void ShownParticles::cut(std::span<const Cut> cuts) {
  cuts_.assign(cuts);
  chosen_.resizeDiscarding(positions_.size);
  dispatch(device_, [&](auto& device) {
    chooseShown(device, positions_, std::as_const(cuts_).view(), chosen_.view(), kept_.data());
  });
  keep({chosen_.data(), found(kept_)});
}

void ShownParticles::giveLone(float spacing, ShownParticles& spray) {
  lone_.find(positions_, spacing);
  spray.positions_ = positions_;
  spray.velocities_ = {}, spray.values_ = {}, spray.kinds_ = {};
  spray.isWhite_ = true;
  spray.keep(lone_.lone());
  keep(lone_.others());
}

void ShownParticles::keep(ArrayView<const int> chosen) {
  keepOf(chosen, positions_, keptPositions_);
  keepOf(chosen, velocities_, keptVelocities_);
  keepOf(chosen, values_, keptValues_);
  keepOf(chosen, kinds_, keptKinds_);
}

template <class T>
void ShownParticles::keepOf(ArrayView<const int> chosen, ArrayView<const T>& elements,
                            std::array<Array<T>, 2>& rooms) {
  if (elements.size == 0) return;
  Array<T>& to = elements.data == rooms[0].data() ? rooms[1] : rooms[0];
  to.resizeDiscarding(chosen.size);
  dispatch(device_, [&](auto& device) { take(device, chosen, elements, to.view()); });
  elements = std::as_const(to).view();
}

template <class T>
T ShownParticles::found(const Array<T>& result) const {
  return result.toHost().front();
}

Aabb ShownParticles::box() {
  dispatch(device_, [&](auto& device) { boxOf(device, positions_, box_.data()); });
  return found(box_);
}

Vec2f ShownParticles::range() {
  dispatch(device_, [&](auto& device) { rangeOf(device, values_, range_.data()); });
  return found(range_);
}

std::optional<Vec3f> ShownParticles::middle() {
  dispatch(device_, [&](auto& device) { sumOf(device, positions_, sum_.data()); });
  const PlacesSum all = found(sum_);
  if (all.count == 0) return std::nullopt;
  const Vec3d middle = all.sum / all.count;
  return Vec3f{static_cast<float>(middle.x), static_cast<float>(middle.y), static_cast<float>(middle.z)};
}

void ShownParticles::give(ParticleView& view, bool onDevice) {
  view.onDevice = onDevice;
  view.positions = onDevice ? spanOf(positions_) : positionsOnHost_.of(positions_);
  view.velocities = onDevice ? std::span<const Vec3f>() : velocitiesOnHost_.of(velocities_);
  if (isWhite_) {
    view.radii = onDevice ? std::span<const float>() : valuesOnHost_.of(values_);
    return;
  }
  const std::span<const float> values = onDevice ? spanOf(values_) : valuesOnHost_.of(values_);
  (view.water ? view.foam : view.values) = values;
}

}  // namespace weir::rendering
