#include "nodes/white_water/fluid_grid.h"

#include "framework/compute/reductions.h"
#include "framework/neighbors/halo_order.h"

namespace weir {

namespace {

struct BoxOfPoint {
  ArrayView<const Vec3f> positions;
  WEIR_HD Aabb operator()(std::int64_t i) const {
    const Vec3f p = positions[i];
    return isFinite(p) ? Aabb{p, p} : Aabb{};
  }
};

/// Those of this rank, and behind them those of others.
struct AllPoints {
  ArrayView<const Vec3f> positions, velocities;
  ArrayView<const std::int64_t> ids;
  std::int64_t own;
  ArrayView<const FluidPoint> beside;

  WEIR_HD bool isOwn(std::int64_t i) const { return i < own; }
  WEIR_HD const FluidPoint& other(std::int64_t i) const { return beside[i - own]; }
  WEIR_HD Vec3f position(std::int64_t i) const { return isOwn(i) ? positions[i] : xyz(other(i).place); }
  WEIR_HD Vec3f velocity(std::int64_t i) const { return isOwn(i) ? velocities[i] : other(i).velocity; }
};

struct IdOfPoint {
  AllPoints points;
  WEIR_HD std::int64_t operator()(std::int64_t i) const {
    return points.isOwn(i) ? points.ids[i] : points.other(i).id;
  }
};

struct CellOfPoint {
  CellGrid grid;
  AllPoints points;
  WEIR_HD int operator()(std::int64_t i) const {
    const Vec3f p = points.position(i);
    return isFinite(p) && isFinite(points.velocity(i)) ? grid.index(grid.cellOf(p)) : -1;
  }
};

struct PutByCell {
  ArrayView<const int> order;
  AllPoints points;
  ArrayView<const float> volumes;  // empty where all have the same
  float volume;
  ArrayView<Vec4f> places;
  ArrayView<Vec3f> byPlace;

  WEIR_HD void operator()(std::int64_t k) const {
    const int i = order[k];
    const Vec3f p = points.position(i);
    places[k] = points.isOwn(i) ? Vec4f{p.x, p.y, p.z, volumes.size > 0 ? volumes[i] : volume}
                                : points.other(i).place;
    byPlace[k] = points.velocity(i);
  }
};

}  // namespace

template <class Backend>
void FluidGrid::findBoxOn(Backend& device, const Particles& fluid) {
  reduce(device, "bounding box", fluid.set().count(), Aabb{},
         BoxOfPoint{std::as_const(fluid.set()).positions().read()}, UniteBoxes{}, box_.data());
}

template <class Backend>
void FluidGrid::sort(Backend& device, const Particles& fluid, ArrayView<const FluidPoint> beside) {
  const ParticleSet& set = fluid.set();
  // Between two frames an emitter may have filled an empty tank.
  constexpr std::int64_t kFew = 1000;
  if (set.bound() > 2 * fittedFor_ + kFew) fit(fluid);
  const Attribute<const float> volumes = fluid.ownValues(fluid.material.volume);
  const AllPoints points{.positions = set.positions().read(),
                         .velocities = set.velocities().read(),
                         .ids = set.ids().read(),
                         .own = set.bound(),
                         .beside = beside};
  // Where there are others, it is known exactly how many are owned.
  const Count all = beside.size > 0 ? Count(set.bound() + beside.size) : set.count();
  sorted_.sort(device, all, grid_.cellCount(), CellOfPoint{grid_, points}, kept_.data());
  parallelFor(device, "order by ids", grid_.cellCount(),
              OrderCellByIds<IdOfPoint>{sorted_.start(), sorted_.orderToChange(), {points}});
  places_.resizeDiscarding(all.bound);
  velocities_.resizeDiscarding(all.bound);
  parallelFor(device, "fluid by cells", count(),
              PutByCell{sorted_.order(), points, volumes ? volumes.read().view() : ArrayView<const float>{},
                        fluid.material.volume.value, places_.view(), velocities_.view()});
}

template void FluidGrid::sort(ThisBackend&, const Particles&, ArrayView<const FluidPoint>);
template void FluidGrid::findBoxOn(ThisBackend&, const Particles&);

}  // namespace weir
