#include "nodes/white_water/fluid_grid.h"

#include "framework/compute/reductions.h"

namespace weir {

namespace {

struct BoxOfPoint {
  ArrayView<const Vec3f> positions;
  WEIR_HD Aabb operator()(std::int64_t i) const {
    const Vec3f p = positions[i];
    return isFinite(p) ? Aabb{p, p} : Aabb{};
  }
};

struct CellOfPoint {
  CellGrid grid;
  ArrayView<const Vec3f> positions, velocities;
  WEIR_HD int operator()(std::int64_t i) const {
    const Vec3f p = positions[i];
    return isFinite(p) && isFinite(velocities[i]) ? grid.index(grid.cellOf(p)) : -1;
  }
};

struct PutByCell {
  ArrayView<const int> order;
  ArrayView<const Vec3f> positions, velocities;
  ArrayView<const float> volumes;  // empty where all have the same
  float volume;
  ArrayView<Vec4f> places;
  ArrayView<Vec3f> byPlace;

  WEIR_HD void operator()(std::int64_t k) const {
    const int i = order[k];
    const Vec3f p = positions[i];
    places[k] = {p.x, p.y, p.z, volumes.size > 0 ? volumes[i] : volume};
    byPlace[k] = velocities[i];
  }
};

}  // namespace

template <class Backend>
void FluidGrid::findBoxOn(Backend& device, const Particles& fluid) {
  reduce(device, "bounding box", fluid.set().count(), Aabb{},
         BoxOfPoint{std::as_const(fluid.set()).positions().read()}, UniteBoxes{}, box_.data());
}

template <class Backend>
void FluidGrid::sort(Backend& device, const Particles& fluid) {
  const ParticleSet& set = fluid.set();
  // Between two frames an emitter may have filled an empty tank.
  constexpr std::int64_t kFew = 1000;
  if (set.bound() > 2 * fittedFor_ + kFew) fit(fluid);
  const ArrayView<const Vec3f> positions = set.positions().read(), velocities = set.velocities().read();
  const Attribute<const float> own = fluid.ownValues(fluid.material.volume);
  sorted_.sort(device, set.count(), grid_.cellCount(), CellOfPoint{grid_, positions, velocities},
               kept_.data());
  places_.resizeDiscarding(set.bound());
  velocities_.resizeDiscarding(set.bound());
  parallelFor(
      device, "fluid by cells", count(),
      PutByCell{sorted_.order(), positions, velocities, own ? own.read().view() : ArrayView<const float>{},
                fluid.material.volume.value, places_.view(), velocities_.view()});
}

template void FluidGrid::sort(ThisBackend&, const Particles&);
template void FluidGrid::findBoxOn(ThisBackend&, const Particles&);

}  // namespace weir
