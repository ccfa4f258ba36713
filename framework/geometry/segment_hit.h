// The first triangle that a segment meets, without holes: a segment that passes through a mesh is never told
// that it does not, not at shared edges and vertices either.
#pragma once

#include "framework/geometry/triangle_tree.h"

namespace weir {

/// The first triangle that the segment from p to q meets.
struct SegmentHit {
  int triangle = -1;    ///< in the order of the tree's leaves, −1 for none
  double fraction = 1;  ///< of the way from p to q
  double height = 0;    ///< of p above the triangle's plane, m, not negative
  Vec3f normal;         ///< the triangle's unit normal, on the side where p is

  WEIR_HD bool found() const { return triangle >= 0; }
};

namespace detail {

WEIR_HD inline Vec3d toDouble(const Vec3f& v) {
  return {v.x, v.y, v.z};
}

struct Volume {
  double value;  ///< u·(v × w)
  int sign;      ///< of the exact value, or 0 where rounding hides it
};

/// The error bound is that of Shewchuk 1997, "Adaptive Precision Floating-Point Arithmetic and Fast Robust
/// Geometric Predicates", for orient3d in double: 7.8e-16 times the sum of the terms' sizes. It holds with
/// and without contracted multiplications. Differences of floats are exact here unless their sizes are 2²⁹
/// apart.
WEIR_HD inline Volume volume(const Vec3d& u, const Vec3d& v, const Vec3d& w) {
  const Vec3d one{v.y * w.z, v.z * w.x, v.x * w.y}, other{v.z * w.y, v.x * w.z, v.y * w.x};
  const Vec3d product = one - other;
  const double value = dot(u, product);
  const double size = std::abs(u.x) * (std::abs(one.x) + std::abs(other.x)) +
                      std::abs(u.y) * (std::abs(one.y) + std::abs(other.y)) +
                      std::abs(u.z) * (std::abs(one.z) + std::abs(other.z));
  const double error = 1e-15 * size;
  return {value, value > error ? 1 : (value < -error ? -1 : 0)};
}

/// Which boxes may come within `margin` of a part of a segment. Never misses one.
class SegmentReach {
 public:
  /// The margin grows by the rounding of all coordinates in the tree's bounds.
  WEIR_HD SegmentReach(const TriangleTreeView& tree, const Vec3f& p, const Vec3f& q, float margin)
      : from_(toDouble(p)), motion_(toDouble(q) - toDouble(p)) {
    const float low = largestCoordinate(tree.bounds.lo), high = largestCoordinate(tree.bounds.hi);
    margin_ = margin + 16 * kEpsilon * ((low > high ? low : high) + margin);
    clip(tree.bounds);
    cut();
  }

  WEIR_HD bool empty() const { return !(first_ <= last_); }

  /// Forgets what comes after this fraction of the segment.
  WEIR_HD void endAt(double fraction) {
    last_ = fraction < last_ ? fraction : last_;
    cut();
  }

  /// By separating axes: those of the box, and the segment's cross products with them.
  WEIR_HD bool meets(const Vec3f& lo, const Vec3f& hi) const {
    const Vec3f c = middle_ - 0.5f * (lo + hi), d = half_, s = max(half_, -half_);
    const Vec3f e = 0.5f * (hi - lo) + Vec3f{margin_, margin_, margin_};
    if (std::abs(c.x) > e.x + s.x || std::abs(c.y) > e.y + s.y || std::abs(c.z) > e.z + s.z) return false;
    return std::abs(c.y * d.z - c.z * d.y) <= e.y * s.z + e.z * s.y &&
           std::abs(c.z * d.x - c.x * d.z) <= e.z * s.x + e.x * s.z &&
           std::abs(c.x * d.y - c.y * d.x) <= e.x * s.y + e.y * s.x;
  }

  WEIR_HD bool meets(const TreeTriangle& t) const {
    return meets(min(min(t.a, t.b), t.c), max(max(t.a, t.b), t.c));
  }

  /// Whether a box's middle comes earlier along the segment than another's.
  WEIR_HD bool earlier(const TreeNode& one, const TreeNode& two) const {
    return dot(one.lo + one.hi, half_) <= dot(two.lo + two.hi, half_);
  }

 private:
  /// To the tree's bounds, so that the rest can be done in floats however long the segment is.
  WEIR_HD void clip(const Aabb& bounds) {
    const double margin = 2.0 * margin_;
    for (int axis = 0; axis < 3; ++axis) {
      const double below = bounds.lo[axis] - margin - from_[axis],
                   above = bounds.hi[axis] + margin - from_[axis], along = motion_[axis];
      if (along == 0) {
        if (below > 0 || above < 0) last_ = -1;
        continue;
      }
      const double in = (along > 0 ? below : above) / along, out = (along > 0 ? above : below) / along;
      first_ = in > first_ ? in : first_;
      last_ = out < last_ ? out : last_;
    }
  }
  WEIR_HD void cut() {
    const Vec3d middle = from_ + 0.5 * (first_ + last_) * motion_, half = 0.5 * (last_ - first_) * motion_;
    middle_ = {static_cast<float>(middle.x), static_cast<float>(middle.y), static_cast<float>(middle.z)};
    half_ = {static_cast<float>(half.x), static_cast<float>(half.y), static_cast<float>(half.z)};
  }

  Vec3d from_, motion_;
  double first_ = 0, last_ = 1;  // the part of the segment
  Vec3f middle_, half_;          // of that part
  float margin_;
};

/// Calls visit(i) with each triangle of a leaf whose box is within reach; visit may shorten the reach. Ends
/// when visit returns false.
template <class Visit>
WEIR_HD void forEachTriangleAlong(const TriangleTreeView& tree, const SegmentReach& reach, Visit&& visit) {
  if (tree.empty() || reach.empty()) return;
  int stack[BoxTree::kDepth + 1];
  int size = 0;
  stack[size++] = 0;
  while (size > 0) {
    const TreeNode node = tree.nodes[stack[--size]];
    if (!reach.meets(node.lo, node.hi)) continue;
    if (node.link > 0) {
      const bool inOrder = reach.earlier(tree.nodes[node.link], tree.nodes[node.link + 1]);
      stack[size++] = node.link + (inOrder ? 1 : 0);
      stack[size++] = node.link + (inOrder ? 0 : 1);
      continue;
    }
    for (int i = node.first; i < node.first - node.link; ++i) {
      if (reach.meets(tree.triangles[i]) && !visit(i)) return;
    }
  }
}

/// Where the segment from p to q meets triangle i of the tree: no triangle if it does not. Signs that
/// rounding hides count as meeting, so of the triangles around an edge or a vertex at least one is met. Only
/// a segment in the plane of the triangle passes: it meets the neighbours, or passes the border of a sheet
/// edge on.
WEIR_HD inline SegmentHit meet(const TriangleTreeView& tree, int i, const Vec3f& p, const Vec3f& q) {
  const TreeTriangle& t = tree.triangles[i];
  const Vec3d from = toDouble(p), to = toDouble(q), motion = to - from;
  const Vec3d a = toDouble(t.a) - from, b = toDouble(t.b) - from, c = toDouble(t.c) - from;
  const Volume start = volume(a, b, c);
  const Volume end = volume(toDouble(t.a) - to, toDouble(t.b) - to, toDouble(t.c) - to);
  if (start.sign * end.sign > 0) return {};
  const int ab = volume(motion, a, b).sign, bc = volume(motion, b, c).sign, ca = volume(motion, c, a).sign;
  const bool anyLeft = ab > 0 || bc > 0 || ca > 0, anyRight = ab < 0 || bc < 0 || ca < 0;
  if (anyLeft && anyRight) return {};
  const bool inPlane = start.sign == 0 && end.sign == 0;
  if (inPlane && !anyLeft && !anyRight) return {};

  SegmentHit hit;
  hit.triangle = i;
  hit.normal = tree.normals[i].normals[PseudoNormals::kFace];
  hit.height = -dot(a, toDouble(hit.normal));
  // On the side of p; where it is in the plane, against the motion.
  const bool isBehind = start.sign != 0 ? start.sign > 0 : dot(toDouble(hit.normal), motion) > 0;
  if (isBehind) hit.normal = -hit.normal, hit.height = -hit.height;
  hit.height = hit.height > 0 ? hit.height : 0;
  const double span = std::abs(start.value) + std::abs(end.value);
  hit.fraction = start.sign == 0 || !(span > 0) ? 0 : std::abs(start.value) / span;
  return hit;
}

}  // namespace detail

/// p and q must be finite. Takes double precision for the few triangles that are near the segment.
WEIR_HD inline SegmentHit firstHit(const TriangleTreeView& tree, const Vec3f& p, const Vec3f& q) {
  SegmentHit first;
  detail::SegmentReach reach(tree, p, q, 0);
  detail::forEachTriangleAlong(tree, reach, [&](int i) {
    const SegmentHit hit = detail::meet(tree, i, p, q);
    if (hit.found() && (!first.found() || hit.fraction < first.fraction)) {
      first = hit;
      reach.endAt(hit.fraction);
    }
    return true;
  });
  return first;
}

/// Calls visit(hit) with each triangle that the segment meets, in an order that depends on the mesh and the
/// segment alone: at an edge or a vertex with more than one. Ends when visit returns false.
template <class Visit>
WEIR_HD void forEachHit(const TriangleTreeView& tree, const Vec3f& p, const Vec3f& q, const Visit& visit) {
  detail::forEachTriangleAlong(tree, detail::SegmentReach(tree, p, q, 0), [&](int i) {
    const SegmentHit hit = detail::meet(tree, i, p, q);
    return !hit.found() || visit(hit);
  });
}

/// Whether a box of a triangle may be as near to the segment as `margin`: cheap, and false only if no
/// triangle is.
WEIR_HD inline bool mayComeNear(const TriangleTreeView& tree, const Vec3f& p, const Vec3f& q, float margin) {
  bool near = false;
  const detail::SegmentReach reach(tree, p, q, margin);
  detail::forEachTriangleAlong(tree, reach, [&](int) {
    near = true;
    return false;
  });
  return near;
}

}  // namespace weir
