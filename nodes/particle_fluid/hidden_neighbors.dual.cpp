#include "nodes/particle_fluid/hidden_neighbors.h"

#include "framework/compute/parallel_uneven.h"
#include "framework/geometry/segment_hit.h"
#include "nodes/particle_fluid/wall_field.h"

namespace weir {

namespace {

/// Whether the way between two particles leads through a thin part of a solid, see the header.
class Passage {
 public:
  WEIR_HD Passage(const SolidView& solid, const Vec3f& p, const Vec3f& q) {
    const TriangleTreeView& tree = solid.tree;
    forEachHit(tree, solid.end.toBody(p), solid.end.toBody(q), [&](const SegmentHit& hit) {
      const bool front = dot(tree.normals[hit.triangle].normals[PseudoNormals::kFace], hit.normal) > 0;
      return add({hit.normal, hit.fraction, front == (solid.kind != SolidKind::kContainer)});
    });
    // One end is within the solid.
    if (count_ > 0 && (enters_ == 0 || enters_ == count_)) blocked_ = true;
  }
  WEIR_HD bool isBlocked() const { return blocked_; }

 private:
  static constexpr int kMax = 8;             // more triangles do block
  static constexpr float kMinCosine = 0.9f;  // of the front and the back of a thin part

  struct Crossing {
    Vec3f against;  // the triangle's normal, against the segment
    double fraction;
    bool enters;
  };

  /// Whether there is need to go on.
  WEIR_HD bool add(const Crossing& crossing) {
    for (int k = 0; k < count_ && !blocked_; ++k) {
      const Crossing& other = crossings_[k];
      if (other.enters == crossing.enters) continue;
      const Crossing &in = crossing.enters ? crossing : other, &out = crossing.enters ? other : crossing;
      blocked_ = in.fraction <= out.fraction && dot(in.against, out.against) > kMinCosine;
    }
    if (count_ == kMax) blocked_ = true;
    if (blocked_) return false;
    crossings_[count_++] = crossing;
    enters_ += crossing.enters;
    return true;
  }

  Crossing crossings_[kMax];
  int count_ = 0, enters_ = 0;
  bool blocked_ = false;
};

struct TakeOutHidden {
  ArrayView<const SolidView> solids;
  SolidPairsView pairs;
  ArrayView<const int> near, sides;  // of pairs
  ImageOwners ownerOf;
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
    const std::int64_t owner = ownerOf(j);
    const std::int64_t from = i < owner ? i : j, to = i < owner ? j : i;
    for (int pair = pairs.begin(i); pair < pairs.end(i); ++pair) {
      const int k = pairs.solid[pair], other = pairs.find(owner, k);
      if (other < 0) continue;
      const SolidView& solid = solids[k];
      if (mayHide(solid.kind, sides[pair], sides[other]) && hides(solid, positions[from], positions[to]))
        return false;
    }
    return true;
  }

  WEIR_HD static bool hides(const SolidView& solid, const Vec3f& p, const Vec3f& q) {
    if (solid.kind != SolidKind::kSheet) return Passage(solid, p, q).isBlocked();
    return firstHit(solid.tree, solid.end.toBody(p), solid.end.toBody(q)).found();
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
                                         fluid.images != nullptr ? fluid.images->owners() : ImageOwners{},
                                         fluid.particles.positions().read(), fluid.neighbors.editor()});
}

template void takeOutHiddenNeighbors(ThisBackend&, FluidStep&);

}  // namespace weir
