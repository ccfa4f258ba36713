// Solids as constraints of a solver that iterates: no particle nearer to a solid than the fluid's `contact`.
//
// Moving particles out after each iteration, and not only after the last, lets walls carry pressure: a floor
// holds the fluid on it within the step, however long the step is.
#pragma once

#include "nodes/particle_fluid/displacement.h"
#include "nodes/static_boundary/boundary_clearance.h"

namespace weir {

/// In a corner, leaving one wall may mean entering another.
inline constexpr int kMaxContacts = 4;

/// p, moved out of solids that are nearer than `radius`.
WEIR_HD inline Vec3f movedOut(const BoundaryView& boundary, float radius, Vec3f p) {
  for (int contacts = 0; contacts < kMaxContacts; ++contacts) {
    const BoundaryHit hit = boundaryQuery(boundary, p);
    if (!(hit.distance < radius)) break;
    p += (radius - hit.distance) * hit.normal;
  }
  return p;
}

#ifdef WEIR_HAS_EIGHT
/// The same of those `near` a box among eight.
inline Vec3<Lanes> movedOut(const Shape& box, float radius, Vec3<Lanes> p, LaneMask near) {
  for (int contacts = 0; contacts < kMaxContacts && any(near); ++contacts) {
    const EightDistances hit = boxDistance(box, p);
    near = near & (hit.distance < Lanes(radius));
    p = select(near, p + (radius - hit.distance) * hit.normal, p);
  }
  return p;
}
#endif

/// Changes displacements so that no particle is nearer to a solid than `radius`.
struct Contain {
  BoundaryView boundary;
  float radius;
  ArrayView<const Vec3f> predicted;
  ArrayView<Vec3f> displacement;
  ArrayView<Vec4f> state;
  /// Where it is not 0, nothing is to be changed any more; may be null. How many passes a solver makes beyond
  /// its last depends on when the host hears of it.
  const int* done = nullptr;

#ifdef WEIR_HAS_EIGHT
  void operator()(Eight i) const {
    if (done != nullptr && *done != 0) return;
    const Vec4<Lanes> before = read(state, i);
    const Vec3<Lanes> p = xyz(before);
    if (boundary.count != 1 || !isBox(boundary.first)) return forEachNear(boundary, radius, i, p, *this);
    const LaneMask near = !(clearance(boundary, p) > Lanes(radius));
    if (!any(near)) return;
    const Vec3<Lanes> q = movedOut(boundary.first.shape, radius, p, near);
    const LaneMask moved = !((p.x == q.x) & (p.y == q.y) & (p.z == q.z));
    if (!any(moved)) return;
    write(displacement, i, select(moved, q - read(predicted, i), read(displacement, i)));
    write(state, i, {q.x, q.y, q.z, zeroUnless(!moved, before.w)});
  }
#endif

  WEIR_HD void operator()(std::int64_t i) const {
    if (done != nullptr && *done != 0) return;
    const Vec3f p = xyz(state[i]);
    const Vec3f q = movedOut(boundary, radius, p);
    if (p == q) return;
    displacement[i] = q - predicted[i];
    state[i] = {q.x, q.y, q.z, 0};
  }
};

/// v of a particle that a wall holds, with what the wall does beside holding it. `approach` is the speed
/// [m/s] towards the wall with which the step began, a part of which is given back; `held` is the wall's
/// push, as a change of speed [m/s]. Friction is Coulomb's: its push is at most that, times a coefficient.
WEIR_HD inline Vec3f heldByWall(const Vec3f& v, const BoundaryHit& wall, float approach, float held) {
  const Vec3f tangential = v - dot(v, wall.normal) * wall.normal;
  const float slip = length(tangential);
  const float kept = slip > 0 ? 1 - wall.friction * held / slip : 0.0f;
  const float bounce = approach > 0 ? wall.restitution * approach : 0.0f;
  return bounce * wall.normal + (kept > 0 ? kept : 0.0f) * tangential;
}

}  // namespace weir
