// What a particle feels of solids that are given by signed distance: the integrals Φ, ∇Φ and D of
// solid_integrals.h, as functions of its place, so that what pushes is exactly the gradient of what is felt.
//
// With q the distance from a plane in radii R of the kernel, a half-space has
//
//   Φ = P(q) = ½·(1 − q)⁵·(1 + 2q)     dP/dq = −3/2·(1 − q)⁴·(1 + 4q)     D = 15/2·(1 − q)⁴/R²     0 ≤ q ≤ 1
//
// and Φ = 1 − P(−q), D = 15/R² − D(−q) behind its surface. What has faces at right angles, boxes and
// cylinders, is the product of slabs: 1 − P(q) − P(q') is the share of the kernel between two planes, exact
// far from edges and on them, and within 0.02 between. Of other solids the kernel sees the half-space at its
// signed distance. Of several solids, it sees what none of them leaves open, so that where they overlap they
// count once. D, which only bounds the length of steps, is the sum of those of all faces.
#pragma once

#include "framework/base/api.h"
#include "framework/compute/eight.h"
#include "framework/solids/solid_integrals.h"
#include "nodes/static_boundary/boundary_clearance.h"

namespace WEIR_API weir {

/// Of a half-space at distance q, in radii of the kernel.
template <class T>
struct FaceIntegrals {
  T phi;
  T slope;  ///< dΦ/dq
  T d;      ///< D·R²
};

/// D·R² deep within a solid.
inline constexpr float kDeepD = 15;

template <class T>
WEIR_HD FaceIntegrals<T> faceIntegrals(const T& q) {
  const T away = detail::magnitude(q), near = positivePart(1 - away), square = near * near,
          fourth = square * square;
  const T phi = 0.5f * fourth * near * (1 + 2 * away), d = 0.5f * kDeepD * fourth;
  const auto behind = q < T(0);
  return {select(behind, 1 - phi, phi), -1.5f * fourth * (1 + 4 * away), select(behind, kDeepD - d, d)};
}

/// Of the matter between two parallel planes at ±half, or beyond them, at the coordinate x.
template <class T>
struct SlabIntegrals {
  T between;  ///< share of the kernel
  T slope;    ///< its derivative by x, 1/m
  T beyondD;  ///< D·R² of what is beyond

  WEIR_HD SlabIntegrals(const T& x, float half, float inverseRadius) {
    const T away = detail::magnitude(x);
    const FaceIntegrals<T> near = faceIntegrals(T((half - away) * inverseRadius));
    between = 1 - near.phi;
    T outwards = near.slope;
    beyondD = near.d;
    // Of planes that are farther apart than the kernel is wide, only the nearer one may be felt.
    if (half * inverseRadius < 1) {
      const FaceIntegrals<T> far = faceIntegrals(T((half + away) * inverseRadius));
      between -= far.phi;
      outwards -= far.slope;
      beyondD += far.d;
    }
    slope = inverseRadius * select(x < T(0), -outwards, outwards);
  }
};

namespace detail {

/// A solid that is what lies between all slabs, or what lies beyond any of them.
template <class T>
WEIR_HD SolidIntegrals<T> ofRoom(const T& share, const Vec3<T>& gradient, const T& leastBetween,
                                 const T& beyond, bool inverted, float inverseRadius) {
  const float scale = inverseRadius * inverseRadius;
  if (inverted) return {1 - share, -gradient, scale * smaller(beyond, T(kDeepD))};
  return {share, gradient, scale * positivePart(leastBetween)};
}

}  // namespace detail

/// Of a box, at one point or several.
template <class T>
WEIR_HD SolidIntegrals<T> boxIntegrals(const Shape& box, float inverseRadius, const Vec3<T>& at) {
  using namespace detail;
  const Vec3<T> p = rotated(conjugate(box.rotation), at - spread<T>(box.position));
  const SlabIntegrals<T> x(p.x, box.halfSize.x, inverseRadius), y(p.y, box.halfSize.y, inverseRadius),
      z(p.z, box.halfSize.z, inverseRadius);
  const T xy = x.between * y.between, yz = y.between * z.between, zx = z.between * x.between;
  const Vec3<T> gradient{x.slope * yz, y.slope * zx, z.slope * xy};
  const T most = larger(larger(x.beyondD, y.beyondD), z.beyondD);
  return ofRoom(xy * z.between, rotated(box.rotation, gradient), kDeepD - most,
                x.beyondD + y.beyondD + z.beyondD, box.inverted, inverseRadius);
}

WEIR_HD inline SolidIntegrals<float> cylinderIntegrals(const Shape& cylinder, float inverseRadius,
                                                       const Vec3f& at) {
  const Vec3f p = rotate(conjugate(cylinder.rotation), at - cylinder.position);
  const float r = sqrtf(p.x * p.x + p.z * p.z);
  const FaceIntegrals<float> side = faceIntegrals((cylinder.radius - r) * inverseRadius);
  const SlabIntegrals<float> ends(p.y, 0.5f * cylinder.height, inverseRadius);
  const float within = 1 - side.phi;
  const float outwards = r > 0 ? inverseRadius * side.slope * ends.between / r : 0;
  const Vec3f gradient{outwards * p.x, within * ends.slope, outwards * p.z};
  const float most = detail::larger(side.d, ends.beyondD);
  return detail::ofRoom(within * ends.between, rotate(cylinder.rotation, gradient), kDeepD - most,
                        side.d + ends.beyondD, cylinder.inverted, inverseRadius);
}

/// Of the half-space at the signed distance.
WEIR_HD inline SolidIntegrals<float> distanceIntegrals(const BoundaryPiece& piece, float inverseRadius,
                                                       const Vec3f& at) {
  const SignedDistance to = piece.query(at);
  const FaceIntegrals<float> face = faceIntegrals(to.distance * inverseRadius);
  return {face.phi, (inverseRadius * face.slope * to.slope) * to.normal,
          inverseRadius * inverseRadius * face.d};
}

WEIR_HD inline SolidIntegrals<float> pieceIntegrals(const BoundaryPiece& piece, float inverseRadius,
                                                    const Vec3f& at) {
  if (isBox(piece)) return boxIntegrals(piece.shape, inverseRadius, at);
  if (!piece.isMesh && piece.shape.kind == ShapeKind::kCylinder)
    return cylinderIntegrals(piece.shape, inverseRadius, at);
  return distanceIntegrals(piece, inverseRadius, at);
}

namespace detail {

/// For points that may be near; the others get nothing, whoever is asked together with them.
template <class T, class Mask>
WEIR_HD SolidIntegrals<T> calibrated(const Mask& near, float factor, const SolidIntegrals<T>& all) {
  const auto times = [&](const T& a) { return zeroUnless(near, T(factor * a)); };
  return {times(all.phi), {times(all.gradPhi.x), times(all.gradPhi.y), times(all.gradPhi.z)}, times(all.d)};
}

}  // namespace detail

// What solids of any kind take costs every sum over neighbours beside it registers, even where there are
// none. So what most fluids have, no such solids or one box, are types of their own.

/// For kernels of a fluid that meets no solids by signed distance.
struct NoBoundary {
  WEIR_HD bool empty() const { return true; }
  template <class T>
  WEIR_HD SolidIntegrals<T> at(const Vec3<T>& /*p*/) const {
    return {};
  }
};

/// For kernels of a fluid that meets one box.
struct BoxBoundary {
  Shape box;
  Aabb around;              ///< a box is felt within it at most, an inverted one outside of it
  float inverseRadius = 0;  ///< 1/R, 1/m
  float factor = 0;         ///< all integrals are times this

  /// Of a piece whose bounds are known.
  static BoxBoundary of(const BoundaryPiece& piece, float radius, float factor) {
    const float out = piece.inverted() ? -radius : radius;
    const Vec3f margin{out, out, out};
    return {piece.shape, {piece.bounds.lo - margin, piece.bounds.hi + margin}, 1 / radius, factor};
  }

  WEIR_HD bool empty() const { return false; }

  /// At one point, or at several.
  template <class T>
  WEIR_HD SolidIntegrals<T> at(const Vec3<T>& p) const {
    const auto near = mayTouch(p);
    if (!any(near)) return {};
    return detail::calibrated(near, factor, boxIntegrals(box, inverseRadius, p));
  }

 private:
  template <class T>
  WEIR_HD auto mayTouch(const Vec3<T>& p) const {
    const Vec3f &lo = around.lo, &hi = around.hi;
    const auto within = (p.x > T(lo.x)) & (p.x < T(hi.x)) & (p.y > T(lo.y)) & (p.y < T(hi.y)) &
                        (p.z > T(lo.z)) & (p.z < T(hi.z));
    return box.inverted ? !within : within;
  }
};

/// For kernels: all solids that a fluid meets, with its kernel for walls.
struct BoundaryIntegrals {
  BoundaryView boundary;
  float radius = 0;  ///< R, m
  float factor = 0;  ///< all integrals are times this

  WEIR_HD bool empty() const { return boundary.count == 0; }
  WEIR_HD bool isOneBox() const {
    return boundary.count == 1 && boundary.first.bounded && isBox(boundary.first);
  }
  /// Only if isOneBox().
  BoxBoundary oneBox() const { return BoxBoundary::of(boundary.first, radius, factor); }

  WEIR_HD SolidIntegrals<float> of(const Vec3f& p) const {
    const float inverseRadius = 1 / radius;
    SolidIntegrals<float> all;
    forEachPiece(boundary, [&](const BoundaryPiece& piece) {
      const SolidIntegrals<float> one = pieceIntegrals(piece, inverseRadius, p);
      all.gradPhi = (1 - one.phi) * all.gradPhi + (1 - all.phi) * one.gradPhi;
      all.phi += one.phi - all.phi * one.phi;
      all.d += one.d;
    });
    return all;
  }

  /// Calls f(piece, ∇Φ) with what each solid adds to the gradient of all, which is their sum.
  template <class F>
  WEIR_HD void forEachPart(const Vec3f& p, const F& f) const {
    const float inverseRadius = 1 / radius;
    forEachPiece(boundary, [&](const BoundaryPiece& piece) {
      Vec3f part = factor * pieceIntegrals(piece, inverseRadius, p).gradPhi;
      if (part == Vec3f{}) return;
      forEachPiece(boundary, [&](const BoundaryPiece& other) {
        if (&other != &piece) part = (1 - pieceIntegrals(other, inverseRadius, p).phi) * part;
      });
      f(piece, part);
    });
  }

  /// At one point, or at several.
  template <class T>
  WEIR_HD SolidIntegrals<T> at(const Vec3<T>& p) const {
    SolidIntegrals<T> all;
    const auto near = mayTouch(boundary, radius, p);
    if (!any(near)) return all;
    if (isOneBox())
      all = boxIntegrals(boundary.first.shape, 1 / radius, p);
    else
      forEachLane(near, [&](int lane) { setLane(all, lane, of(laneOf(p, lane))); });
    return detail::calibrated(near, factor, all);
  }

 private:
  template <class T>
  WEIR_HD static void setLane(SolidIntegrals<T>& all, int lane, const SolidIntegrals<float>& one) {
    weir::setLane(all.phi, lane, one.phi);
    weir::setLane(all.gradPhi, lane, one.gradPhi);
    weir::setLane(all.d, lane, one.d);
  }
};

}  // namespace weir
