#include "nodes/particle_fluid/modules/wall_integrals.h"

#include "framework/solids/find_solids.h"
#include "nodes/particle_fluid/hidden_neighbors.h"

namespace weir {

namespace {

struct StoreIntegrals {
  ArrayView<Vec4f> each, total;
  ArrayView<float> d;
  ArrayView<Vec3f> diagonal, off;  // of the curvature; empty where nobody asks for it
  ArrayView<int> sides;

  WEIR_HD void operator()(int pair, const FoundSolid& found) const {
    sides[pair] = found.sides;
    each[pair] = stored(found.integrals);
  }
  WEIR_HD void all(int i, const FoundSolid& sum) const {
    total[i] = stored(sum.integrals);
    d[i] = sum.integrals.d;
    if (diagonal.size == 0) return;
    diagonal[i] = sum.curvature.diagonal;
    off[i] = sum.curvature.off;
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
  walls.keepFoundAt(fluid.particles.positions().read());
  walls.remainder = {};
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
                            .diagonal = walls.curvature.view(),
                            .off = walls.curvatureOff.view(),
                            .sides = walls.sides.view()},
             /*alwaysTeams=*/fluid.divided != nullptr);
  takeOutHiddenNeighbors(device, fluid);
}

template void WallIntegrals::findOn(ThisBackend&, FluidStep&);

}  // namespace weir
