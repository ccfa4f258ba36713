#include "nodes/particle_fluid/modules/boundary_collision.h"

#include "framework/compute/eight.h"
#include "nodes/static_boundary/boundary_clearance.h"

namespace weir {

namespace {

struct Collide {
  BoundaryView boundary;
  float radius;
  ArrayView<Vec3f> positions, velocities;

#ifdef WEIR_HAS_EIGHT
  /// Most particles are far from all walls.
  void operator()(Eight i) const {
    forEachNear(boundary, radius, i, read(positions, i), *this);
  }
#endif

  WEIR_HD void operator()(std::int64_t i) const {
    // In a corner, leaving one wall may mean entering another.
    constexpr int kMostContacts = 4;
    Vec3f p = positions[i];
#ifdef __CUDA_ARCH__
    if (clearance(boundary, p) > radius) return;
#endif
    Vec3f v;
    int contacts = 0;
#ifdef __CUDA_ARCH__
#pragma unroll 1
#endif
    for (; contacts < kMostContacts; ++contacts) {
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
