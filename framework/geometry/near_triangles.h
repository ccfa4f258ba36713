// The triangles near a point, gathered in one walk down the tree for several questions about its
// surroundings.
//
// They are few where a mesh is not much finer than what meets it. Where they are more than there is room for,
// and for questions that reach beyond them, the tree answers: so answers never depend on what was gathered,
// but for which of several equally near triangles is named.
#pragma once

#include "framework/geometry/box_blocks.h"
#include "framework/geometry/segment_hit.h"

namespace weir {

class NearTriangles {
 public:
  static constexpr int kMax = 24;

  /// All triangles that may be as near to `center` as `radius` (m).
  WEIR_HD NearTriangles(const TriangleTreeView& tree, const Vec3f& center, float radius)
      : tree_(tree), center_(center), radius_(radius) {
    // What rounding may add to the distances by which they are chosen and asked for.
    const float low = detail::largestCoordinate(tree.bounds.lo),
                high = detail::largestCoordinate(tree.bounds.hi);
    const float slack = 32 * detail::kEpsilon * ((low > high ? low : high) + radius);
#ifdef WEIR_HAS_LANES
    if (tree.blocks != nullptr) {
      count_ = tree.blocks->near(center, radius + slack, index_, kMax);
      return;
    }
#endif
    count_ = WalkNear(tree, center, radius + slack).next(index_, kMax + 1);
  }

  /// As TriangleTreeView::nearest.
  WEIR_HD SurfacePoint nearest(const Vec3f& p, float atMost) const {
    if (!holds(p, atMost)) return tree_.nearest(p, atMost);
    NearestTriangle search(p, atMost);
    for (int k = 0; k < count_; ++k) search.ask(tree_, index_[k]);
    return search.found(tree_, atMost);
  }

  /// As firstHit of segment_hit.h.
  WEIR_HD SegmentHit firstHit(const Vec3f& p, const Vec3f& q) const {
    if (!holds(p, 0) || !holds(q, 0)) return weir::firstHit(tree_, p, q);
    SegmentHit first;
    const detail::SegmentReach reach(tree_, p, q, 0);
    for (int k = 0; k < count_ && !reach.empty(); ++k) {
      if (!reach.meets(tree_.triangles[index_[k]])) continue;
      const SegmentHit hit = detail::meet(tree_, index_[k], p, q);
      if (hit.found() && (!first.found() || hit.fraction < first.fraction)) first = hit;
    }
    return first;
  }

  /// As mayComeNear of segment_hit.h.
  WEIR_HD bool mayComeNear(const Vec3f& p, const Vec3f& q, float margin) const {
    if (!holds(p, margin) || !holds(q, margin)) return weir::mayComeNear(tree_, p, q, margin);
    const detail::SegmentReach reach(tree_, p, q, margin);
    bool near = false;
    for (int k = 0; k < count_ && !near && !reach.empty(); ++k)
      near = reach.meets(tree_.triangles[index_[k]]);
    return near;
  }

 private:
  /// Whether everything that is as near to p as `within` is among those that were gathered.
  WEIR_HD bool holds(const Vec3f& p, float within) const {
    return count_ <= kMax && length(p - center_) + within <= radius_;
  }

  const TriangleTreeView& tree_;
  Vec3f center_;
  float radius_;
  int count_;                                 // kMax + 1 if there are more
  int index_[kMax + BoxBlocks::kEightBoxes];  // the CPU writes eight at once
};

}  // namespace weir
