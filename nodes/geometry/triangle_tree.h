// A tree of boxes around the triangles of a rigid mesh, as kernels on both back ends ask it.
#pragma once

#include "framework/compute/array.h"
#include "nodes/geometry/box_tree.h"

namespace weir {

namespace detail {

/// 32 bytes, so that a node comes in two loads of 16.
struct TreeNode {
  Vec3f lo;
  int link = 0;  ///< the first child (the second comes next), or in leaves −(number of triangles)
  Vec3f hi;
  int first = 0;  ///< a leaf's first triangle
};

struct TreeTriangle {
  Vec3f a, b, c;  ///< counter-clockwise as in the mesh
};

WEIR_HD inline float squaredDistanceToBox(const Vec3f& lo, const Vec3f& hi, const Vec3f& p) {
  const Vec3f out = max(max(lo - p, p - hi), Vec3f{});
  return dot(out, out);
}

}  // namespace detail

/// Plain data for kernels; valid as long as its TriangleTree.
struct TriangleTreeView {
  ArrayView<const detail::TreeNode> nodes;
  ArrayView<const detail::TreeTriangle> triangles;  ///< in the order of the leaves
  ArrayView<const int> indices;                     ///< of those triangles in the mesh
  Aabb bounds;                                      ///< of the mesh

  WEIR_HD bool empty() const { return triangles.size == 0; }

  /// Calls f(a, b, c) with the corners of every triangle, counter-clockwise as in the mesh, that may be as
  /// near to p as `radius`: of all whose boxes are. Misses none; each comes once, in an order that depends on
  /// the mesh alone.
  template <class F>
  WEIR_HD void forEachTriangleNear(const Vec3f& p, float radius, F&& f) const;
};

/// Owns the arrays. The mesh's vertices must be finite; triangles without area are allowed.
class TriangleTree {
 public:
  TriangleTree() = default;  ///< empty
  /// Builds on the host in O(n log n), then copies to the device.
  TriangleTree(Device& device, const TriangleMesh& mesh);

  TriangleTreeView view() const;

 private:
  Array<detail::TreeNode> nodes_;
  Array<detail::TreeTriangle> triangles_;
  Array<int> indices_;
  Aabb bounds_;
};

template <class F>
WEIR_HD void TriangleTreeView::forEachTriangleNear(const Vec3f& p, float radius, F&& f) const {
  if (empty()) return;
  // The squares are off by a few roundings; what is within them is reported.
  const float reach = radius * radius * (1 + 1e-6f);
  int stack[BoxTree::kDepth + 1];
  int size = 0;
  stack[size++] = 0;
  while (size > 0) {
    const detail::TreeNode node = nodes[stack[--size]];
    if (detail::squaredDistanceToBox(node.lo, node.hi, p) > reach) continue;
    if (node.link > 0) {
      stack[size++] = node.link + 1;
      stack[size++] = node.link;
      continue;
    }
    for (int i = node.first; i < node.first - node.link; ++i) {
      const detail::TreeTriangle t = triangles[i];
      if (detail::squaredDistanceToBox(min(min(t.a, t.b), t.c), max(max(t.a, t.b), t.c), p) <= reach)
        f(t.a, t.b, t.c);
    }
  }
}

}  // namespace weir
