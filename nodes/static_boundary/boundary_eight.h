// Which of eight particles may be near walls, on the CPU: mostly none is, and walls need not be asked one by
// one.
#pragma once

#include <bit>
#include <limits>

#include "framework/compute/eight.h"
#include "nodes/static_boundary/boundary.h"

#ifdef WEIR_HAS_EIGHT

namespace weir {

namespace detail {

inline Vec3<Lanes> inLanes(const Vec3f& v) {
  return {v.x, v.y, v.z};
}

[[gnu::always_inline]] inline Vec3<Lanes> rotated(const Quatf& q, const Vec3<Lanes>& v) {
  const Vec3<Lanes> u = inLanes({q.x, q.y, q.z});
  const Vec3<Lanes> t = 2.0f * cross(u, v);
  return v + q.w * t + cross(u, t);
}

[[gnu::always_inline]] inline Lanes larger(const Lanes& a, const Lanes& b) {
  return select(a > b, a, b);
}
[[gnu::always_inline]] inline Lanes smaller(const Lanes& a, const Lanes& b) {
  return select(a < b, a, b);
}

/// Those of eight points p that are no nearer than `radius` to any of the pieces for certain. Knows boxes
/// only.
[[gnu::always_inline]] inline LaneMask isClear(const BoundaryView& boundary, float radius,
                                               const Vec3<Lanes>& p) {
  constexpr float kRounding = 1e-4f;  // of the size
  Lanes least = std::numeric_limits<float>::max();
  for (int k = 0; k < boundary.count; ++k) {
    const BoundaryPiece& piece = boundary.pieces[k];
    const Shape& shape = piece.shape;
    if (piece.isMesh || shape.kind != ShapeKind::kBox) return Lanes(0) > Lanes(0);
    const Vec3<Lanes> local = rotated(conjugate(shape.rotation), p - inLanes(shape.position));
    const Vec3f& half = shape.halfSize;
    // The distance from the plane of a face bounds that from the box.
    const Lanes out = larger(larger(abs(local.x) - half.x, abs(local.y) - half.y), abs(local.z) - half.z);
    least = smaller(least, (shape.inverted ? -out : out) - kRounding * (half.x + half.y + half.z));
  }
  return least > Lanes(radius);
}

}  // namespace detail

/// Calls f(k) for the indices k among the eight, with positions p, that may be nearer to a boundary than
/// `radius`.
template <class F>
[[gnu::always_inline]] inline void forEachNear(const BoundaryView& boundary, float radius, Eight i,
                                               const Vec3<Lanes>& p, const F& f) {
  unsigned near = ~detail::isClear(boundary, radius, p).bits() & 0xffu;
  for (; near != 0; near &= near - 1) f(i.first + std::countr_zero(near));
}

}  // namespace weir

#endif
