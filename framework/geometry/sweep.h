// Moves a point against a rigid mesh, at any speed, so that it never gets to the other side: collide and
// slide.
#pragma once

#include "framework/geometry/clearance_grid.h"
#include "framework/geometry/near_triangles.h"

namespace weir {

struct SweepResult {
  Vec3f position;  ///< m, in the mesh's frame
  int hit = 0;     ///< 1 if the mesh changed where the point went; no bool, so that no byte is left unset
  /// Unit vector away from what was hit, on the side of the point: the mean of all contacts, weighted by the
  /// motion that each took. Zero without a hit, and where the point was only held for want of room.
  Vec3f normal;
};

namespace detail {

class Sweep {
 public:
  static constexpr int kSlides = 8;    // contacts of one motion
  static constexpr int kPushes = 4;    // a corner of three faces needs three
  static constexpr int kHalvings = 3;  // of a motion that ends where there is no room

  WEIR_HD Sweep(const NearTriangles& mesh, float thickness, float rounding)
      : mesh_(mesh), thickness_(thickness), rounding_(rounding) {}

  WEIR_HD SweepResult run(const Vec3f& from, const Vec3f& to, const Vec3f& towards) {
    const float way = length(to - from);
    const SurfacePoint nearest = mesh_.nearest(from, way + thickness_ + rounding_);
    if (nearest.triangle < 0) return {to};
    const bool onSurface = nearest.distance < rounding_;
    Vec3f p = onSurface ? offSurface(nearest, towards) : from;
    const float atStart = onSurface ? mesh_.nearest(p, thickness_).distance : nearest.distance;
    kept_ = atStart < kRoom * thickness_ ? kKept * atStart : kRoom * thickness_;
    Vec3f target = to, before;
    for (int slide = 0; slide < kSlides; ++slide) {
      const SegmentHit hit = mesh_.firstHit(p, target);
      if (!hit.found()) {
        goTowards(target, p, true);
        break;
      }
      // Back to where the height above the plane is the thickness.
      const float share =
          hit.height > thickness_ ? static_cast<float>(hit.fraction * (1 - thickness_ / hit.height)) : 0;
      const Vec3f rest = target - p;
      goTowards(p + share * rest, p, false);
      target = p + along(hit.normal, before, (1 - share) * rest);
      before = hit.normal;
    }
    return {p, hit_, normalized(contact_)};
  }

 private:
  static constexpr float kRoom = 0.5f;       // of the thickness: nearer than that, nothing may come to rest
  static constexpr float kNear = 0.9f;       // of the thickness: nearer than that, it is pushed away
  static constexpr float kKept = 1 - 1e-3f;  // of its distance, a point that starts nearer still must keep

  WEIR_HD void addContact(const Vec3f& normal, float weight) {
    contact_ += (weight > 0 ? weight : 0) * normal;
    hit_ = true;
  }

  /// A point on the surface, up to rounding, goes in front of it, on the side that `towards` points to.
  WEIR_HD Vec3f offSurface(const SurfacePoint& near, const Vec3f& towards) const {
    const bool hinted = dot(towards, towards) > 0;
    const bool front = hinted ? dot(towards, near.normal) >= 0 : near.side >= 0;
    const Vec3f normal = front ? near.normal : -near.normal;
    const Vec3f start = near.position + 2 * rounding_ * normal, target = near.position + thickness_ * normal;
    const SegmentHit hit = mesh_.firstHit(start, target);
    return hit.found() ? start + 0.5f * static_cast<float>(hit.fraction) * (target - start) : target;
  }

  /// What is left of a motion in contact with a plane, or between that plane and the one of the contact
  /// before.
  WEIR_HD Vec3f along(const Vec3f& normal, const Vec3f& before, Vec3f rest) {
    const float into = -dot(rest, normal);
    addContact(normal, into);
    if (into > 0) rest += into * normal;
    if (!(dot(rest, before) < 0)) return rest;
    const Vec3f crease = normalized(cross(normal, before));
    return dot(rest, crease) * crease;
  }

  /// Moves p to `target`, or as far as there is room. `open` if it is known that nothing is in between.
  WEIR_HD void goTowards(Vec3f target, Vec3f& p, bool open) {
    for (int k = 0; k <= kHalvings; ++k) {
      Vec3f q = target;
      if ((open || !mesh_.firstHit(p, q).found()) && settle(q)) {
        p = q;
        return;
      }
      hit_ = true;
      open = false;
      target = p + 0.5f * (target - p);
    }
  }

  /// Pushes q away from what is nearer than the thickness. False if that does not give it room.
  WEIR_HD bool settle(Vec3f& q) {
    for (int k = 0; k < kPushes; ++k) {
      const SurfacePoint near = mesh_.nearest(q, kNear * thickness_);
      if (near.triangle < 0) return true;
      if (near.distance <= rounding_) return false;
      const Vec3f away = (q - near.position) / near.distance;
      const Vec3f pushed = near.position + thickness_ * away;
      if (mesh_.firstHit(q, pushed).found()) break;
      addContact(away, thickness_ - near.distance);
      q = pushed;
    }
    return !(mesh_.nearest(q, kept_).distance < kept_);
  }

  const NearTriangles& mesh_;
  float thickness_, rounding_;
  float kept_ = 0;  // distance of any place to stay
  Vec3f contact_;
  bool hit_ = false;
};

}  // namespace detail

/// The thinnest that `sweep` takes a mesh for at coordinates of this size: 32 roundings. Thinner is taken for
/// that.
WEIR_HD inline float minThickness(float coordinate) {
  return 32 * detail::kEpsilon * coordinate;
}

namespace detail {

WEIR_HD inline float largestCoordinate(const TriangleTreeView& tree, const Vec3f& p) {
  return largestCoordinate(max(max(p, -p), max(tree.bounds.hi, -tree.bounds.lo)));
}

}  // namespace detail

/// Whether two look-ups are enough to know that `sweep` will not change this motion.
WEIR_HD inline bool isClear(const TriangleTreeView& tree, const ClearanceView& clearance, const Vec3f& from,
                            const Vec3f& to, float thickness) {
  if (tree.empty() || !isFinite(from) || !isFinite(to)) return true;
  const float min = minThickness(detail::largestCoordinate(tree, from));
  return clearance.clears(from, to, thickness > min ? thickness : min);
}

/// Moves a point from `from` straight to `to` against a mesh, both in the mesh's frame (for a mesh that
/// moves: `from` in its pose when the step begins, `to` in its pose when it ends). Where it hits, it stops
/// `thickness` (m) in front of what it hit; what motion is left loses its part into the surface and goes on
/// along it, at most Sweep::kSlides times. Faces hold on both sides, so open sheets do too.
///
/// Every piece of its way is tested by `firstHit`, from and to the very floats that are kept, so no sequence
/// of calls in which `from` is the position before gets to the other side. Where the caller moves the point
/// between two frames, the rounding of that must stay below half the thickness, which holds for thickness >=
/// leastThickness(largest coordinate); a smaller one is raised to it.
///
/// The result is no nearer than half of the thickness to any triangle, about a thickness where there is room
/// for it. Where there is none, the point stays at the last place where there was. A point that starts nearer
/// keeps its distance, and where it can goes to a thickness. A point that starts on the surface, up to
/// leastThickness/8, is put in front of it: on the side that `towards` points to, a vector of
/// any length such as the last contact's normal; without one, on the side of `from` if floats can tell,
/// otherwise on that of the triangles' normals.
///
/// A motion that comes nowhere near the mesh costs two look-ups in the clearance of the same mesh, or one
/// walk down the tree if that is empty. Points that are NaN or infinite pass.
WEIR_HD inline SweepResult sweep(const TriangleTreeView& tree, const ClearanceView& clearance,
                                 const Vec3f& from, const Vec3f& to, float thickness,
                                 const Vec3f& towards = {}) {
  if (isClear(tree, clearance, from, to, thickness)) return {to};
  const float min = minThickness(detail::largestCoordinate(tree, from));
  thickness = thickness > min ? thickness : min;
  // No contact takes it farther than its way, and pushes are of a thickness at most.
  const NearTriangles mesh(tree, from, length(to - from) + 3 * thickness);
  if (!mesh.mayComeNear(from, to, thickness)) return {to};
  return detail::Sweep(mesh, thickness, 0.125f * min).run(from, to, towards);
}

}  // namespace weir
