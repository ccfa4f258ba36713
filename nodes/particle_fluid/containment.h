// Solids as constraints of a solver that iterates: no particle nearer to a solid than the fluid's `contact`.
//
// Moving particles out after each iteration, and not only after the last, lets walls carry pressure: a floor
// holds the fluid on it within the step, however long the step is.
#pragma once

#include "nodes/particle_fluid/displacement.h"
#include "nodes/static_boundary/boundary_clearance.h"

namespace weir {

/// Changes displacements so that no particle is nearer to a solid than `radius`.
struct Contain {
  BoundaryView boundary;
  float radius;
  ArrayView<const Vec3f> predicted;
  ArrayView<Vec3f> displacement;
  ArrayView<Vec4f> state;
  /// m; gains what each particle is moved by. Empty where nobody asks.
  ArrayView<Vec3f> held = {};
  /// Where it is not 0, nothing is to be changed any more; may be null. How many passes a solver makes beyond
  /// its last depends on when the host hears of it.
  const int* done = nullptr;

  template <class Index>
  WEIR_HD void operator()(Index i) const {
    if (done != nullptr && *done != 0) return;
    const auto before = read(state, i);
    const auto p = xyz(before);
    auto q = p;
    moveOut(boundary, radius, q, [](const auto&, const auto&) {});
    const auto moved = !((p.x == q.x) & (p.y == q.y) & (p.z == q.z));
    if (!any(moved)) return;
    write(displacement, i, select(moved, q - read(predicted, i), read(displacement, i)));
    write(state, i, {q.x, q.y, q.z, zeroUnless(!moved, before.w)});
    if (held.size > 0) write(held, i, read(held, i) + (q - p));
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
