// A bound of the distance from walls that costs little: mostly no particle is near, and walls need not be
// asked for more. Where they must be and are one box, as tanks mostly are, eight points ask it at once.
#pragma once

#include <bit>

#include "framework/compute/eight.h"
#include "nodes/static_boundary/boundary.h"

namespace weir {

namespace detail {

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

}  // namespace detail

/// What bounds the distance of one or eight points from a box, from below. The distance from the plane of a
/// face bounds that from the box.
template <class T>
WEIR_HD T boxClearance(const Shape& shape, const Vec3<T>& p) {
  using namespace detail;
  constexpr float kRounding = 1e-4f;  // of the size
  const Vec3<T> local = rotated(conjugate(shape.rotation), p - spread<T>(shape.position));
  const Vec3f& half = shape.halfSize;
  const T out =
      larger(larger(magnitude(local.x) - half.x, magnitude(local.y) - half.y), magnitude(local.z) - half.z);
  return (shape.inverted ? -out : out) - kRounding * (half.x + half.y + half.z);
}

WEIR_HD inline bool isBox(const BoundaryPiece& piece) {
  return !piece.isMesh && piece.shape.kind == ShapeKind::kBox;
}

/// The same for all solids; what is no box counts as near.
template <class T>
WEIR_HD T clearance(const BoundaryView& boundary, const Vec3<T>& p) {
  constexpr float kFar = 1e30f;
  T least = kFar;
  forEachPiece(boundary, [&](const BoundaryPiece& piece) {
    least = isBox(piece) ? detail::smaller(least, boxClearance(piece.shape, p)) : T(-kFar);
  });
  return least;
}

#ifdef WEIR_HAS_EIGHT

inline Vec3<Lanes> select(const LaneMask& condition, const Vec3<Lanes>& ifTrue, const Vec3<Lanes>& ifFalse) {
  return {select(condition, ifTrue.x, ifFalse.x), select(condition, ifTrue.y, ifFalse.y),
          select(condition, ifTrue.z, ifFalse.z)};
}

struct EightDistances {
  Lanes distance;
  Vec3<Lanes> normal;
};

/// signedDistance() of eight points from a box, in the same operations.
inline EightDistances boxDistance(const Shape& box, const Vec3<Lanes>& at) {
  using namespace detail;
  const Lanes zero(0.0f), one(1.0f);
  const Vec3<Lanes> p = rotated(conjugate(box.rotation), at - spread<Lanes>(box.position));
  const Vec3<Lanes> q{abs(p.x) - box.halfSize.x, abs(p.y) - box.halfSize.y, abs(p.z) - box.halfSize.z};
  const Vec3<Lanes> sign{select(p.x < zero, -one, one), select(p.y < zero, -one, one),
                         select(p.z < zero, -one, one)};
  const Vec3<Lanes> out{larger(q.x, zero), larger(q.y, zero), larger(q.z, zero)};
  const Lanes beyond = sqrtf(dot(out, out));
  const LaneMask outside = beyond > zero, x = !(q.x < q.y) & !(q.x < q.z), y = !x & !(q.y < q.z);
  const auto along = [&](const LaneMask& nearest, const Lanes& part, const Lanes& axis) {
    return select(outside, axis * (part / beyond), zeroUnless(nearest, axis));
  };
  const Vec3<Lanes> n{along(x, out.x, sign.x), along(y, out.y, sign.y), along(!x & !y, out.z, sign.z)};
  const Vec3<Lanes> normal = rotated(box.rotation, n);
  const Lanes distance = select(outside, beyond, select(x, q.x, select(y, q.y, q.z)));
  return box.inverted ? EightDistances{-distance, -normal} : EightDistances{distance, normal};
}

/// Calls f(k) for the indices k among the eight, with positions p, that may be nearer to a boundary than
/// `radius`.
template <class F>
[[gnu::always_inline]] inline void forEachNear(const BoundaryView& boundary, float radius, Eight i,
                                               const Vec3<Lanes>& p, const F& f) {
  unsigned near = ~(clearance(boundary, p) > Lanes(radius)).bits() & 0xffu;
  for (; near != 0; near &= near - 1) f(i.first + std::countr_zero(near));
}

#endif

}  // namespace weir
