// A bound of the distance from walls that costs little: mostly no particle is near, and walls need not be
// asked for more. Where they must be and are one box, as tanks mostly are, eight points ask it at once.
#pragma once

#include <cmath>
#include <type_traits>

#include "framework/base/api.h"
#include "framework/compute/eight.h"
#include "framework/compute/repeat.h"
#include "nodes/static_boundary/boundary.h"

namespace WEIR_API weir {

namespace detail {

template <class T>
WEIR_HD Vec3<T> spread(const Vec3f& v) {
  return {T(v.x), T(v.y), T(v.z)};
}

template <class T>
WEIR_HD Vec3<T> rotated(const Quatf& q, const Vec3<T>& v) {
  // As most are.
  if (q.x == 0 && q.y == 0 && q.z == 0) return v;
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
  // Without std, C's abs() of whole numbers may be meant.
  if constexpr (std::is_floating_point_v<T>)
    return std::fabs(a);
  else
    return abs(a);
}

}  // namespace detail

WEIR_HD inline bool isBox(const BoundaryPiece& piece) {
  return !piece.isMesh && piece.shape.kind == ShapeKind::kBox;
}

/// What bounds the distance of one or eight points from a solid, from below. The distance from the plane of a
/// face bounds that from the box.
template <class T>
WEIR_HD T clearance(const BoundaryPiece& piece, const Vec3<T>& p) {
  using namespace detail;
  constexpr float kFar = 1e30f;
  if (!piece.bounded) return T(-kFar);
  const Vec3f &lo = piece.bounds.lo, &hi = piece.bounds.hi;
  const T out = larger(larger(larger(lo.x - p.x, p.x - hi.x), larger(lo.y - p.y, p.y - hi.y)),
                       larger(lo.z - p.z, p.z - hi.z));
  return piece.inverted() ? -out : out;
}

/// The same for all solids.
template <class T>
WEIR_HD T clearance(const BoundaryView& boundary, const Vec3<T>& p) {
  constexpr float kFar = 1e30f;
  T min = kFar;
  forEachPiece(boundary,
               [&](const BoundaryPiece& piece) { min = detail::smaller(min, clearance(piece, p)); });
  return min;
}

/// Which points may be nearer to a boundary than `radius`.
template <class T>
WEIR_HD auto mayTouch(const BoundaryView& boundary, float radius, const Vec3<T>& p) {
  return !(clearance(boundary, p) > T(radius));
}

/// Calls f(k) for the indices k among those of i, with positions p, that may be nearer to a boundary than
/// `radius`.
template <class Index, class T, class F>
WEIR_HD void forEachNear(const BoundaryView& boundary, float radius, Index i, const Vec3<T>& p, const F& f) {
  forEachLane(mayTouch(boundary, radius, p), [&](int lane) { f(indexOf(i, lane)); });
}

/// BoundaryPiece::query() of a box, without branches.
template <class T>
WEIR_HD BoundaryHitOf<T> boxQuery(const BoundaryPiece& piece, const Vec3<T>& at) {
  using namespace detail;
  const Shape& box = piece.shape;
  const T zero(0.0f), one(1.0f);
  const Vec3<T> p = rotated(conjugate(box.rotation), at - spread<T>(box.position));
  const Vec3<T> q{magnitude(p.x) - box.halfSize.x, magnitude(p.y) - box.halfSize.y,
                  magnitude(p.z) - box.halfSize.z};
  const Vec3<T> sign{select(p.x < zero, -one, one), select(p.y < zero, -one, one),
                     select(p.z < zero, -one, one)};
  const Vec3<T> out{larger(q.x, zero), larger(q.y, zero), larger(q.z, zero)};
  const T beyond = sqrtf(dot(out, out));
  const auto outside = beyond > zero, x = !(q.x < q.y) & !(q.x < q.z), y = !x & !(q.y < q.z);
  const auto along = [&](const auto& nearest, const T& part, const T& axis) {
    return select(outside, axis * (part / beyond), zeroUnless(nearest, axis));
  };
  const Vec3<T> n{along(x, out.x, sign.x), along(y, out.y, sign.y), along(!x & !y, out.z, sign.z)};
  const Vec3<T> normal = rotated(box.rotation, n);
  const T distance = select(outside, beyond, select(x, q.x, select(y, q.y, q.z)));
  const T restitution(piece.restitution), friction(piece.friction);
  if (box.inverted) return {-distance, -normal, restitution, friction};
  return {distance, normal, restitution, friction};
}

/// boundaryQuery() of several points, for those that are `asked`.
template <class T, class Mask>
WEIR_HD BoundaryHitOf<T> boundaryQuery(const BoundaryView& boundary, const Vec3<T>& p, const Mask& asked) {
  if (boundary.count == 1 && isBox(boundary.first)) return boxQuery(boundary.first, p);
  BoundaryHitOf<T> hits;
  forEachLane(asked, [&](int lane) {
    const BoundaryHit hit = boundaryQuery(boundary, laneOf(p, lane));
    setLane(hits.distance, lane, hit.distance);
    setLane(hits.normal, lane, hit.normal);
    setLane(hits.restitution, lane, hit.restitution);
    setLane(hits.friction, lane, hit.friction);
  });
  return hits;
}
WEIR_HD inline BoundaryHit boundaryQuery(const BoundaryView& boundary, const Vec3f& p, bool /*asked*/) {
  return boundaryQuery(boundary, p);
}

/// Moves p, one point or several, out of solids that are nearer than `radius`. At each contact it calls
/// touch(touching, hit) for the points that are touching.
template <class T, class F>
WEIR_HD void moveOut(const BoundaryView& boundary, float radius, Vec3<T>& p, const F& touch) {
  constexpr int kMaxContacts = 4;  // in a corner, leaving one wall may mean entering another
  auto touching = mayTouch(boundary, radius, p);
  if (!any(touching)) return;
  repeatUpTo(kMaxContacts, [&] {
    const auto hit = boundaryQuery(boundary, p, touching);
    touching = touching & (hit.distance < T(radius));
    if (!any(touching)) return false;
    p = select(touching, p + (radius - hit.distance) * hit.normal, p);
    touch(touching, hit);
    return true;
  });
}

}  // namespace weir
