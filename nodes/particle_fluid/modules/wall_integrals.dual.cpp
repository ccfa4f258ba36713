#include "nodes/particle_fluid/modules/wall_integrals.h"

#include "framework/solids/find_solids.h"
#include "nodes/particle_fluid/hidden_neighbors.h"

namespace weir {

namespace {

struct IsNear {
  ArrayView<const SolidView> solids;
  float reach;
  ArrayView<const Vec3f> positions;

  WEIR_HD bool operator()(std::int64_t i) const {
    const Vec3f p = positions[i];
    for (std::int64_t k = 0; k < solids.size; ++k)
      if (!(solids[k].clearance.at(solids[k].end.toBody(p)) > reach)) return true;
    return false;
  }
};

struct StoreIntegrals {
  std::int64_t stride;
  ArrayView<Vec4f> each, total;  // total is empty where there is one solid
  ArrayView<float> d;
  ArrayView<int> sides;

  WEIR_HD void operator()(int i, std::int64_t k, const FoundSolid& found) const {
    sides[k * stride + i] = found.sides;
    each[k * stride + i] = stored(found.integrals);
  }
  WEIR_HD void operator()(int i, const SolidIntegrals<float>& sum) const {
    if (total.size > 0) total[i] = stored(sum);
    d[i] = sum.d;
  }
  WEIR_HD static Vec4f stored(const SolidIntegrals<float>& of) {
    return {of.gradPhi.x, of.gradPhi.y, of.gradPhi.z, of.phi};
  }
};

}  // namespace

template <class Backend>
void WallIntegrals::findOn(Backend& device, FluidStep& fluid) {
  WallField& walls = fluid.walls;
  walls.fit(fluid.particles);
  const bool several = walls.solids.size() > 1;
  walls.keepLegal(fluid.particles.positions().read());
  walls.base = {};
  const ArrayView<const SolidView> solids = walls.views.view();
  const ArrayView<const Vec3f> positions = fluid.particles.positions().read();
  const float reach = fluid.constants.supportRadius;
  walls.list(device, "near solids", fluid.particles.count(), IsNear{solids, reach, positions}, walls.near,
             walls.nearCounter);
  // All others feel nothing and see nothing.
  walls.each.fillZero();
  if (several) walls.total.fillZero();
  walls.d.fillZero();
  walls.sides.fillZero();
  findSolids(device, "wall integrals", walls.nearCount(),
             {.solids = solids,
              .radius = fluid.constants.wallRadius,
              .reach = reach,
              .calibration = fluid.constants.wallFactor,
              .near = std::as_const(walls.near).view(),
              .positions = positions},
             StoreIntegrals{.stride = walls.stride,
                            .each = walls.each.view(),
                            .total = several ? walls.total.view() : ArrayView<Vec4f>{},
                            .d = walls.d.view(),
                            .sides = walls.sides.view()});
  takeOutHiddenNeighbors(device, fluid);
}

template void WallIntegrals::findOn(ThisBackend&, FluidStep&);

}  // namespace weir
