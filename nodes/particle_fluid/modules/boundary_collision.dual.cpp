#include "nodes/particle_fluid/modules/boundary_collision.h"

#include "framework/compute/eight.h"
#include "nodes/static_boundary/boundary_clearance.h"

namespace weir {

namespace {

struct Collide {
  // In a corner, leaving one wall may mean entering another.
  static constexpr int kMaxContacts = 4;

  BoundaryView boundary;
  float radius;
  ArrayView<Vec3f> positions, velocities;

#ifdef WEIR_HAS_EIGHT
  /// Most particles are far from all walls.
  void operator()(Eight i) const {
    const Vec3<Lanes> p = read(positions, i);
    if (boundary.count == 1 && isBox(boundary.first))
      collideWithBox(i, p, !(clearance(boundary, p) > Lanes(radius)));
    else
      forEachNear(boundary, radius, i, p, *this);
  }

  /// Those `near`; the same operations as for one particle.
  void collideWithBox(Eight i, Vec3<Lanes> p, const LaneMask& near) const {
    const BoundaryPiece& box = boundary.first;
    Vec3<Lanes> v;
    LaneMask touching = near;
    int contacts = 0;
    for (; contacts < kMaxContacts && any(touching); ++contacts) {
      const EightDistances hit = boxDistance(box.shape, p);
      touching = touching & (hit.distance < Lanes(radius));
      if (!any(touching)) break;
      if (contacts == 0) v = read(velocities, i);
      p = select(touching, p + (radius - hit.distance) * hit.normal, p);
      v = select(touching, reflected(v, hit.normal, box.restitution, box.friction), v);
    }
    if (contacts == 0) return;
    write(positions, i, p);
    write(velocities, i, v);
  }

  static Vec3<Lanes> reflected(const Vec3<Lanes>& v, const Vec3<Lanes>& normal, float restitution,
                               float friction) {
    const Lanes zero(0.0f), normalSpeed = dot(v, normal);
    const Lanes change = -(1 + restitution) * normalSpeed;
    const Vec3<Lanes> tangential = v - normalSpeed * normal;
    const Lanes slip = sqrtf(dot(tangential, tangential));
    const Lanes kept = select(slip > zero, 1 - friction * change / slip, zero);
    const Vec3<Lanes> bounced =
        (normalSpeed + change) * normal + select(kept > zero, kept, zero) * tangential;
    return select((normalSpeed > zero) | (normalSpeed == zero), v, bounced);
  }
#endif

  WEIR_HD void operator()(std::int64_t i) const {
    Vec3f p = positions[i];
#ifdef __CUDA_ARCH__
    if (clearance(boundary, p) > radius) return;
#endif
    Vec3f v;
    int contacts = 0;
#ifdef __CUDA_ARCH__
#pragma unroll 1
#endif
    for (; contacts < kMaxContacts; ++contacts) {
      const BoundaryHit hit = boundaryQuery(boundary, p);
      if (!(hit.distance < radius)) break;
      // Few particles touch a wall, so velocities are not read before.
      if (contacts == 0) v = velocities[i];
      p += (radius - hit.distance) * hit.normal;
      v = reflected(v, hit);
    }
    if (contacts == 0) return;
    positions[i] = p;
    velocities[i] = v;
  }

  WEIR_HD static Vec3f reflected(const Vec3f& v, const BoundaryHit& hit) {
    const float normalSpeed = dot(v, hit.normal);
    if (normalSpeed >= 0) return v;
    const float change = -(1 + hit.restitution) * normalSpeed;
    const Vec3f tangential = v - normalSpeed * hit.normal;
    const float slip = length(tangential);
    const float kept = slip > 0 ? 1 - hit.friction * change / slip : 0.0f;
    return (normalSpeed + change) * hit.normal + (kept > 0 ? kept : 0.0f) * tangential;
  }
};

}  // namespace

template <class Backend>
void BoundaryCollision::stepOn(Backend& device, FluidStep& fluid) {
  for (const Boundary* boundary : fluid.boundaries)
    parallelForEights(device, "collide", fluid.particles.count(),
                      Collide{boundary->view(), fluid.constants.contact, fluid.particles.positions().view(),
                              fluid.particles.velocities().view()});
}

template void BoundaryCollision::stepOn(ThisBackend&, FluidStep&);

}  // namespace weir
