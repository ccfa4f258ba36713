#include "nodes/particle_fluid/modules/boundary_collision.h"

#include <bit>
#include <limits>

#include "framework/compute/eight.h"
#include "nodes/static_boundary/boundary.h"

namespace weir {

namespace {

template <class T>
WEIR_HD Vec3<T> spread(const Vec3f& v) {
  return {T(v.x), T(v.y), T(v.z)};
}

template <class T>
WEIR_HD Vec3<T> rotated(const Quatf& q, const Vec3<T>& v) {
  const Vec3<T> u = spread<T>({q.x, q.y, q.z});
  const Vec3<T> t = 2.0f * cross(u, v);
  return v + q.w * t + cross(u, t);
}

template <class T>
WEIR_HD T larger(const T& a, const T& b) {
  return select(a > b, a, b);
}
template <class T>
WEIR_HD T smaller(const T& a, const T& b) {
  return select(a < b, a, b);
}
template <class T>
WEIR_HD T magnitude(const T& a) {
  return larger(a, -a);
}

struct Collide {
  BoundaryView boundary;
  float radius;
  ArrayView<Vec3f> positions, velocities;

#ifdef WEIR_HAS_EIGHT
  /// Most particles are far from all walls.
  void operator()(Eight i) const {
    unsigned near = ~(clearance(read(positions, i)) > Lanes(radius)).bits() & 0xffu;
    for (; near != 0; near &= near - 1) (*this)(i.first + std::countr_zero(near));
  }

#endif

  /// What bounds the distance of one or eight points from the solids, from below; boxes only, others count as
  /// near.
  template <class T>
  WEIR_HD T clearance(const Vec3<T>& p) const {
    constexpr float kRounding = 1e-4f;  // of the size
    constexpr float kFar = 1e30f;
    T least = kFar;
    for (int k = 0; k < boundary.count; ++k) {
      const BoundaryPiece& piece = boundary.pieces[k];
      const Shape& shape = piece.shape;
      if (piece.isMesh || shape.kind != ShapeKind::kBox) return T(-kFar);
      const Vec3<T> local = rotated(conjugate(shape.rotation), p - spread<T>(shape.position));
      const Vec3f& half = shape.halfSize;
      // The distance from the plane of a face bounds that from the box.
      const T out = larger(larger(magnitude(local.x) - half.x, magnitude(local.y) - half.y),
                           magnitude(local.z) - half.z);
      least = smaller(least, (shape.inverted ? -out : out) - kRounding * (half.x + half.y + half.z));
    }
    return least;
  }

  WEIR_HD void operator()(std::int64_t i) const {
    // In a corner, leaving one wall may mean entering another.
    constexpr int kMostContacts = 4;
    Vec3f p = positions[i];
#ifdef __CUDA_ARCH__
    if (clearance(p) > radius) return;
#endif
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
