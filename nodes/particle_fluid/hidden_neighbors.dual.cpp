#include "nodes/particle_fluid/hidden_neighbors.h"

#include "framework/compute/parallel_uneven.h"
#include "framework/geometry/segment_hit.h"
#include "nodes/particle_fluid/wall_field.h"

namespace weir {

namespace {

struct TakeOutHidden {
  ArrayView<const SolidView> solids;
  SolidPairsView pairs;
  ArrayView<const int> near, sides;  // of pairs
  ArrayView<const Vec3f> positions;
  NeighborEditor neighbors;

  WEIR_HD void operator()(std::int64_t n, const Team& team) const {
    const int i = near[n];
    bool any = false;
    for (int pair = pairs.begin(i); pair < pairs.end(i); ++pair) {
      const int seen = sides[pair];
      any =
          any || (solids[pairs.solid[pair]].kind == SolidKind::kSheet ? seen != 0 : (seen & kSeesBack) != 0);
    }
    if (any) neighbors.keepIf(i, team, [&](int j) { return sees(i, j); });
  }

  WEIR_HD bool sees(std::int64_t i, std::int64_t j) const {
    const std::int64_t from = i < j ? i : j, to = i < j ? j : i;
    for (int pair = pairs.begin(i); pair < pairs.end(i); ++pair) {
      const int k = pairs.solid[pair], other = pairs.find(j, k);
      if (other < 0) continue;
      const SolidView& solid = solids[k];
      if (mayHide(solid.kind, sides[pair], sides[other]) &&
          firstHit(solid.tree, solid.end.toBody(positions[from]), solid.end.toBody(positions[to])).found())
        return false;
    }
    return true;
  }

  WEIR_HD static bool mayHide(SolidKind kind, int one, int other) {
    if (kind != SolidKind::kSheet) return (one & other & kSeesBack) != 0;
    return ((one & kSeesFront) != 0 && (other & kSeesBack) != 0) ||
           ((one & kSeesBack) != 0 && (other & kSeesFront) != 0);
  }
};

}  // namespace

template <class Backend>
void takeOutHiddenNeighbors(Backend& device, FluidStep& fluid) {
  WallField& walls = fluid.walls;
  constexpr TeamPlan kPlan{16, 1 << 17};
  parallelForUneven<kPlan>(device, "hidden neighbours", walls.pairs.nearCount(),
                           TakeOutHidden{walls.views.view(), walls.pairs.view(), walls.pairs.near(),
                                         std::as_const(walls.sides).view(),
                                         fluid.particles.positions().read(), fluid.neighbors.editor()});
}

template void takeOutHiddenNeighbors(ThisBackend&, FluidStep&);

}  // namespace weir
