// A tree of boxes around the triangles of a rigid mesh, as kernels on both back ends ask it.
#pragma once

#include <memory>

#include "framework/base/api.h"
#include "framework/compute/parallel.h"
#include "framework/geometry/box_tree.h"
#include "framework/geometry/pseudo_normals.h"

namespace WEIR_API weir {

class BoxBlocks;

namespace detail {

/// 32 bytes, so that a node comes in two loads of 16.
struct alignas(16) TreeNode {
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

/// Where a mesh is nearest to some point p.
struct SurfacePoint {
  Vec3f position;      ///< m
  Vec3f normal;        ///< pseudo-normal of the face, edge or corner that it lies on; see PseudoNormals
  float distance = 0;  ///< from p, m
  int triangle = -1;   ///< index in the mesh; −1 if nothing is near enough
  /// +1 if p is on the side that the triangles' normals point to, −1 on the other; 0 where floats cannot
  /// tell: on the surface, or beside an open border in the plane of the sheet.
  int side = 0;
};

/// Plain data for kernels; valid as long as its TriangleTree.
struct TriangleTreeView {
  ArrayView<const detail::TreeNode> nodes;
  ArrayView<const detail::TreeTriangle> triangles;  ///< in the order of the leaves
  ArrayView<const PseudoNormals> normals;           ///< of those triangles
  ArrayView<const int> indices;                     ///< of those triangles in the mesh
  Aabb bounds;                                      ///< of the mesh
  const BoxBlocks* blocks = nullptr;                ///< on the CPU only

  WEIR_HD bool empty() const { return triangles.size == 0; }

  /// Calls f(a, b, c) with the corners of every triangle, counter-clockwise as in the mesh, that may be as
  /// near to p as `radius`: of all whose boxes are. Misses none; each comes once, in an order that depends on
  /// the mesh alone. The threads of a team share them.
  template <class F>
  WEIR_HD void forEachTriangleNear(const Vec3f& p, float radius, F&& f, const Team& team = {}) const;

  /// The point of the mesh that is nearest to p, found faster the smaller `atMost` (m, may be infinite) is.
  /// If nothing is nearer than `atMost`, the triangle is −1 and the distance `atMost`. Distances are exact up
  /// to a few roundings of the coordinates.
  WEIR_HD SurfacePoint nearest(const Vec3f& p, float atMost) const;
};

/// Owns the arrays. The mesh's vertices must be finite; triangles without area are allowed.
class TriangleTree {
 public:
  TriangleTree();  ///< empty
  /// Builds on the host in O(n log n), then copies to the device.
  TriangleTree(Device& device, const TriangleMesh& mesh);
  TriangleTree(TriangleTree&&) noexcept;
  TriangleTree& operator=(TriangleTree&&) noexcept;
  ~TriangleTree();

  TriangleTreeView view() const;
  /// Bytes on the device that a tree of that many triangles takes at most.
  static double maxMemory(std::size_t triangles);

 private:
  Array<detail::TreeNode> nodes_;
  Array<detail::TreeTriangle> triangles_;
  Array<PseudoNormals> normals_;
  Array<int> indices_;
  Aabb bounds_;
  std::unique_ptr<BoxBlocks> blocks_;
};

namespace detail {

/// The point of a triangle that is nearest to the origin.
struct ClosestPoint {
  Vec3f position;
  float squared = 0;
  int feature = 0;  ///< index in PseudoNormals
};

WEIR_HD inline ClosestPoint closestOnSegment(const Vec3f& a, const Vec3f& b, int edge) {
  const Vec3f along = b - a;
  const float reach = -dot(a, along), squaredLength = dot(along, along);
  if (!(reach > 0)) return {a, dot(a, a), PseudoNormals::kCorners + edge};
  if (!(reach < squaredLength)) return {b, dot(b, b), PseudoNormals::kCorners + (edge + 1) % 3};
  const Vec3f at = a + (reach / squaredLength) * along;
  return {at, dot(at, at), PseudoNormals::kEdges + edge};
}

/// The nearest point if it may be nearer than √atMost; nothing nearer than that if not. `normal` is the
/// triangle's unit normal, zero for triangles without area. Passed in, because that of a sliver is not to be
/// had in floats.
WEIR_HD inline ClosestPoint closestOnTriangle(const Vec3f& a, const Vec3f& b, const Vec3f& c,
                                              const Vec3f& normal, float atMost) {
  const Vec3f ab = b - a, bc = c - b, ca = a - c;
  if (dot(normal, normal) > 0) {
    // The origin's foot in the plane is inside if it lies left of all edges.
    const float height = dot(a, normal);
    const float one = dot(cross(a, ab), normal), two = dot(cross(b, bc), normal),
                three = dot(cross(c, ca), normal);
    if (one >= 0 && two >= 0 && three >= 0) return {height * normal, height * height, PseudoNormals::kFace};
    // All of the triangle is beyond an edge's line, seen from the foot; with room for rounding.
    const float within = 1.001f * atMost - height * height;
    const auto isBeyond = [within](float left, const Vec3f& along) {
      return left < 0 && left * left > within * dot(along, along);
    };
    if (isBeyond(one, ab) || isBeyond(two, bc) || isBeyond(three, ca)) return {{}, atMost, 0};
  }
  ClosestPoint best = closestOnSegment(a, b, 0);
  const ClosestPoint second = closestOnSegment(b, c, 1), third = closestOnSegment(c, a, 2);
  if (second.squared < best.squared) best = second;
  if (third.squared < best.squared) best = third;
  return best;
}

WEIR_HD inline float largestCoordinate(const Vec3f& v) {
  const Vec3f size = max(v, -v);
  return size.x > size.y ? (size.x > size.z ? size.x : size.z) : (size.y > size.z ? size.y : size.z);
}

constexpr float kEpsilon = 1.1920929e-7f;  // of floats

}  // namespace detail

/// The nearest of the triangles that it is asked about.
class NearestTriangle {
 public:
  /// To p, of those nearer than `atMost` (m, may be infinite).
  WEIR_HD NearestTriangle(const Vec3f& p, float atMost) : p_(p), closest_{.squared = atMost * atMost} {}

  /// The square of the distance within which triangles still matter.
  WEIR_HD float squared() const { return closest_.squared; }

  /// About triangle i, in the order of the leaves.
  WEIR_HD void ask(const TriangleTreeView& tree, int i) {
    const detail::TreeTriangle t = tree.triangles[i];
    const detail::ClosestPoint candidate = detail::closestOnTriangle(
        t.a - p_, t.b - p_, t.c - p_, tree.normals[i].normals[PseudoNormals::kFace], closest_.squared);
    if (candidate.squared < closest_.squared) closest_ = candidate, best_ = i;
  }

  /// `atMost` as it was.
  WEIR_HD SurfacePoint found(const TriangleTreeView& tree, float atMost) const {
    SurfacePoint point{.distance = atMost};
    if (best_ < 0) return point;
    point.position = p_ + closest_.position;
    point.normal = tree.normals[best_].normals[closest_.feature];
    point.distance = std::sqrt(closest_.squared);
    point.triangle = tree.indices[best_];
    const float height = -dot(closest_.position, point.normal);
    const float rounding = 4 * detail::kEpsilon * (detail::largestCoordinate(p_) + point.distance);
    point.side = height > rounding ? 1 : (height < -rounding ? -1 : 0);
    return point;
  }

 private:
  Vec3f p_;
  detail::ClosestPoint closest_;
  int best_ = -1;
};

WEIR_HD inline SurfacePoint TriangleTreeView::nearest(const Vec3f& p, float atMost) const {
  NearestTriangle search(p, atMost);
  if (empty()) return search.found(*this, atMost);
  struct Pending {
    int node;
    float squared;
  };
  Pending stack[BoxTree::kDepth + 1];
  int size = 0;
  stack[size++] = {0, detail::squaredDistanceToBox(bounds.lo, bounds.hi, p)};
  while (size > 0) {
    const Pending next = stack[--size];
    if (!(next.squared < search.squared())) continue;
    const detail::TreeNode node = nodes[next.node];
    if (node.link > 0) {
      const detail::TreeNode one = nodes[node.link], two = nodes[node.link + 1];
      const Pending first{node.link, detail::squaredDistanceToBox(one.lo, one.hi, p)};
      const Pending second{node.link + 1, detail::squaredDistanceToBox(two.lo, two.hi, p)};
      const bool firstIsNearer = first.squared <= second.squared;
      stack[size++] = firstIsNearer ? second : first;
      stack[size++] = firstIsNearer ? first : second;
      continue;
    }
    for (int i = node.first; i < node.first - node.link; ++i) search.ask(*this, i);
  }
  return search.found(*this, atMost);
}

/// A walk down the tree to all triangles that may be as near to p as `radius`: of all whose boxes are. It
/// finds some at a time, so that the lanes of a GPU that work on what they found do it side by side, and not
/// while others still walk.
class WalkNear {
 public:
  WEIR_HD WalkNear(const TriangleTreeView& tree, const Vec3f& p, float radius)
      // The squares are off by a few roundings; what is within them is reported.
      : tree_(tree), p_(p), reach_(radius * radius * (1 + 1e-6f)) {
    if (!tree.empty()) stack_[size_++] = 0;
  }

  /// Writes the next triangles, in the order of the leaves, and returns how many: fewer than `max` at the
  /// end.
  WEIR_HD int next(int* found, int room) {
    int count = 0;
    while (true) {
      for (; leaf_ < leafEnd_ && count < room; ++leaf_) {
        const detail::TreeTriangle t = tree_.triangles[leaf_];
        if (isNear(min(min(t.a, t.b), t.c), max(max(t.a, t.b), t.c))) found[count++] = leaf_;
      }
      if (count == room || size_ == 0) return count;
      const detail::TreeNode node = tree_.nodes[stack_[--size_]];
      if (!isNear(node.lo, node.hi)) continue;
      if (node.link > 0) {
        stack_[size_++] = node.link + 1;
        stack_[size_++] = node.link;
      } else {
        leaf_ = node.first, leafEnd_ = node.first - node.link;
      }
    }
  }

 private:
  WEIR_HD bool isNear(const Vec3f& lo, const Vec3f& hi) const {
    return detail::squaredDistanceToBox(lo, hi, p_) <= reach_;
  }

  const TriangleTreeView& tree_;
  Vec3f p_;
  float reach_;
  int stack_[BoxTree::kDepth + 1];
  int size_ = 0, leaf_ = 0, leafEnd_ = 0;
};

template <class F>
WEIR_HD void TriangleTreeView::forEachTriangleNear(const Vec3f& p, float radius, F&& f,
                                                   const Team& team) const {
  constexpr int kAtOnce = Team::kMax;
  int found[kAtOnce], count;
  WalkNear walk(*this, p, radius);
  do {
    count = walk.next(found, kAtOnce);
    for (int k = team.lane; k < count; k += team.size) {
      const detail::TreeTriangle t = triangles[found[k]];
      f(t.a, t.b, t.c);
    }
  } while (count == kAtOnce);
}

}  // namespace weir
