#include "nodes/particle_fluid/modules/wall_integrals.h"

#include "framework/solids/find_solids.h"
#include "nodes/particle_fluid/hidden_neighbors.h"

namespace weir {

namespace {

struct StoreIntegrals {
  ArrayView<Vec4f> each, total;
  ArrayView<float> d;
  ArrayView<int> sides;

  WEIR_HD void operator()(int pair, const FoundSolid& found) const {
    sides[pair] = found.sides;
    each[pair] = stored(found.integrals);
  }
  WEIR_HD void operator()(int i, const SolidIntegrals<float>& sum) const {
    total[i] = stored(sum);
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
  walls.keepLegal(fluid.particles.positions().read());
  walls.base = {};
  const ArrayView<const SolidView> solids = walls.views.view();
  const ArrayView<const Vec3f> positions = fluid.particles.positions().read();
  const float reach = fluid.constants.supportRadius;
  walls.findPairs(device, fluid.particles.count(), positions, reach);
  // All others feel nothing.
  walls.total.fillZero();
  walls.d.fillZero();
  if (walls.moves) walls.lift.fillZero();
  findSolids(device, "wall integrals", walls.pairs.nearCount(),
             {.solids = solids,
              .radius = fluid.constants.wallRadius,
              .reach = reach,
              .calibration = fluid.constants.wallFactor,
              .near = walls.pairs.near(),
              .pairs = walls.pairs.view(),
              .positions = positions},
             StoreIntegrals{.each = walls.each.view(),
                            .total = walls.total.view(),
                            .d = walls.d.view(),
                            .sides = walls.sides.view()},
             /*alwaysTeams=*/fluid.divided != nullptr);
  takeOutHiddenNeighbors(device, fluid);
}

template void WallIntegrals::findOn(ThisBackend&, FluidStep&);

}  // namespace weir
