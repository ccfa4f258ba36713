#include "nodes/particle_fluid/modules/boundary_collision.h"

#include "framework/compute/eight.h"
#include "nodes/static_boundary/boundary_clearance.h"

namespace weir {

namespace {

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

}  // namespace

template <class Backend>
void BoundaryCollision::stepOn(Backend& device, FluidStep& fluid) {
  for (const Boundary* boundary : fluid.boundaries)
    parallelForEights(device, "collide", fluid.particles.count(),
                      Collide{boundary->view(), fluid.constants.contact, fluid.particles.positions().write(),
                              fluid.particles.velocities().write()});
}

template void BoundaryCollision::stepOn(ThisBackend&, FluidStep&);

}  // namespace weir
