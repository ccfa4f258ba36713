#include "nodes/particle_fluid/modules/boundary_collision.h"

#include <bit>
#include <limits>

#include "framework/compute/eight.h"
#include "nodes/static_boundary/boundary.h"

namespace weir {

namespace {

#ifdef WEIR_HAS_EIGHT

Vec3<Lanes> inLanes(const Vec3f& v) {
  return {v.x, v.y, v.z};
}

Vec3<Lanes> rotated(const Quatf& q, const Vec3<Lanes>& v) {
  const Vec3<Lanes> u = inLanes({q.x, q.y, q.z});
  const Vec3<Lanes> t = 2.0f * cross(u, v);
  return v + q.w * t + cross(u, t);
}

Lanes larger(const Lanes& a, const Lanes& b) {
  return select(a > b, a, b);
}
Lanes smaller(const Lanes& a, const Lanes& b) {
  return select(a < b, a, b);
}
Lanes magnitude(const Lanes& a) {
  return larger(a, -a);
}

#endif

struct Collide {
  BoundaryView boundary;
  float radius;
  ArrayView<Vec3f> positions, velocities;

#ifdef WEIR_HAS_EIGHT
  /// Most particles are far from all walls.
  void operator()(Eight i) const {
    unsigned near = ~isClear(read(positions, i)).bits() & 0xffu;
    for (; near != 0; near &= near - 1) (*this)(i.first + std::countr_zero(near));
  }

  /// Those of eight particles that touch none of the pieces for certain. Knows boxes only.
  LaneMask isClear(const Vec3<Lanes>& p) const {
    constexpr float kRounding = 1e-4f;  // of the size
    Lanes least = std::numeric_limits<float>::max();
    for (int k = 0; k < boundary.count; ++k) {
      const BoundaryPiece& piece = boundary.pieces[k];
      const Shape& shape = piece.shape;
      if (piece.isMesh || shape.kind != ShapeKind::kBox) return Lanes(0) > Lanes(0);
      const Vec3<Lanes> local = rotated(conjugate(shape.rotation), p - inLanes(shape.position));
      const Vec3f& half = shape.halfSize;
      // The distance from the plane of a face bounds that from the box.
      const Lanes out = larger(larger(magnitude(local.x) - half.x, magnitude(local.y) - half.y),
                               magnitude(local.z) - half.z);
      least = smaller(least, (shape.inverted ? -out : out) - kRounding * (half.x + half.y + half.z));
    }
    return least > Lanes(radius);
  }
#endif

  WEIR_HD void operator()(std::int64_t i) const {
    // In a corner, leaving one wall may mean entering another.
    constexpr int kMostContacts = 4;
    Vec3f p = positions[i];
    BoundaryHit hit = boundaryQuery(boundary, p);
    // Few particles touch a wall, so velocities are not read before.
    if (!(hit.distance < radius)) return;
    Vec3f v = velocities[i];
    for (int contacts = 0; contacts < kMostContacts && hit.distance < radius; ++contacts) {
      p += (radius - hit.distance) * hit.normal;
      v = reflected(v, hit);
      hit = boundaryQuery(boundary, p);
    }
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
