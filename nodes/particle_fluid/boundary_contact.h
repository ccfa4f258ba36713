// How particles bounce off solids that are given by signed distance, and rub on them: laws of impulses, so
// that their effect over time does not depend on dt.
#pragma once

#include "nodes/particle_fluid/wall_field.h"
#include "nodes/static_boundary/boundary_clearance.h"

namespace weir {

/// Puts a particle nearer than `radius` to that distance. The velocity into the wall is reflected with the
/// restitution e, and Coulomb friction takes at most μ times that change from the part along the wall:
///
///   Δv_n = −(1 + e)·v_n  (if v_n < 0)        v_t ← v_t·max(0, 1 − μ·|Δv_n|/|v_t|)
struct Collide {
  BoundaryView boundary;
  float radius;
  ArrayView<Vec3f> positions, velocities;

  template <class Index>
  WEIR_HD void operator()(Index i) const {
    auto p = read(positions, i);
    decltype(p) v;
    bool touched = false;
    moveOut(boundary, radius, p, [&](const auto& touching, const auto& hit) {
      // Few particles touch a wall, so velocities are not read before.
      if (!touched) v = read(velocities, i);
      touched = true;
      v = select(touching, reflected(v, hit), v);
    });
    if (!touched) return;
    write(positions, i, p);
    write(velocities, i, v);
  }

  template <class T>
  WEIR_HD static Vec3<T> reflected(const Vec3<T>& v, const BoundaryHitOf<T>& hit) {
    const T zero(0), normalSpeed = dot(v, hit.normal);
    const T change = -(1 + hit.restitution) * normalSpeed;
    const Vec3<T> tangential = v - normalSpeed * hit.normal;
    const T slip = sqrtf(dot(tangential, tangential));
    const T kept = select(slip > zero, 1 - hit.friction * change / slip, zero);
    const Vec3<T> bounced = (normalSpeed + change) * hit.normal + positivePart(kept) * tangential;
    return select((normalSpeed > zero) | (normalSpeed == zero), v, bounced);
  }
};

/// The same at walls that have restitution, before pressure slows what flies at them. What is as slow as
/// something at rest, which gravity pulls at the wall in every step, stays where it is.
struct Bounce {
  Collide collide;
  float slow;  // m/s

  template <class Index>
  WEIR_HD void operator()(Index i) const {
    forEachNear(collide.boundary, collide.radius, i, read(collide.positions, i),
                [&](std::int64_t k) { bounce(k); });
  }

  WEIR_HD void bounce(std::int64_t i) const {
    constexpr int kMaxContacts = 4;
    for (int contact = 0; contact < kMaxContacts; ++contact) {
      const Vec3f p = collide.positions[i], v = collide.velocities[i];
      const BoundaryHit hit = boundaryQuery(collide.boundary, p);
      const bool bounces = hit.restitution > 0 && dot(v, hit.normal) < -slow;
      if (!bounces || !(hit.distance < collide.radius)) return;
      collide.positions[i] = p + (collide.radius - hit.distance) * hit.normal;
      collide.velocities[i] = Collide::reflected(v, hit);
    }
  }
};

/// Coulomb's friction of particles that pressure holds off a wall: of the push that the wall has given.
struct WallFriction {
  BoundaryIntegrals walls;
  float inverseDt;
  ArrayView<const Vec3f> positions;
  ArrayView<const float> share;
  ArrayView<Vec3f> velocities;

  template <class Index>
  WEIR_HD void operator()(Index i) const {
    forEachNear(walls.boundary, walls.radius, i, read(positions, i),
                [&](std::int64_t k) { applyFriction(k); });
  }

  WEIR_HD void applyFriction(std::int64_t i) const {
    const Vec3f p = positions[i], push = (inverseDt * share[i]) * walls.at(p).gradPhi;
    const float held = length(push);
    if (!(held > 0)) return;
    const float friction = boundaryQuery(walls.boundary, p).friction;
    const Vec3f v = velocities[i], normal = push / held, across = dot(v, normal) * normal, along = v - across;
    const float slip = length(along);
    if (!(slip > 0)) return;
    velocities[i] = across + positivePart(1 - friction * held / slip) * along;
  }
};

}  // namespace weir
