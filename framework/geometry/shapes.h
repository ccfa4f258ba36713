// Signed distances to analytic solids: exact, in float, on both back ends.
//
// All solids are given in a frame of their own, with y as the axis of symmetry, and placed by position and
// rotation. Distances are in metres, negative inside; normals are unit vectors that point out of the solid.
#pragma once

#include <cmath>

#include "framework/base/api.h"
#include "framework/base/vec.h"

namespace WEIR_API weir {

enum class ShapeKind { kBox, kSphere, kCylinder, kCapsule, kCone, kPlane };

/// A solid that kernels can query. Lengths in metres.
struct Shape {
  ShapeKind kind = ShapeKind::kBox;
  Vec3f position;
  Quatf rotation;
  Vec3f halfSize;    ///< box
  float radius = 0;  ///< sphere, cylinder, capsule, base of the cone
  float height = 0;  ///< cylinder and capsule: of the axis, centred; cone: from the base at y = 0 to the tip
  bool inverted = false;  ///< the solid is all that is outside
};

struct SignedDistance {
  float distance = 0;  ///< m
  Vec3f normal;
  float slope = 1;  ///< length of the distance's gradient: not 1 where it is interpolated
};

namespace detail {

struct Point2 {
  float x, y;
};

WEIR_HD inline SignedDistance boxDistance(const Vec3f& p, const Vec3f& h) {
  const Vec3f q{fabsf(p.x) - h.x, fabsf(p.y) - h.y, fabsf(p.z) - h.z};
  const Vec3f sign{p.x < 0 ? -1.0f : 1.0f, p.y < 0 ? -1.0f : 1.0f, p.z < 0 ? -1.0f : 1.0f};
  const Vec3f out = max(q, Vec3f{});
  const float outside = length(out);
  if (outside > 0) {
    const Vec3f n = out / outside;
    return {outside, {sign.x * n.x, sign.y * n.y, sign.z * n.z}};
  }
  if (q.x >= q.y && q.x >= q.z) return {q.x, {sign.x, 0, 0}};
  if (q.y >= q.z) return {q.y, {0, sign.y, 0}};
  return {q.z, {0, 0, sign.z}};
}

/// A solid of revolution from its half-plane: distance and normal in (r, y) become those in space.
WEIR_HD inline SignedDistance revolved(const Vec3f& p, float r, float distance, const Point2& normal) {
  const Vec3f radial = r > 0 ? Vec3f{p.x / r, 0, p.z / r} : Vec3f{1, 0, 0};
  return {distance, {normal.x * radial.x, normal.y, normal.x * radial.z}};
}

WEIR_HD inline SignedDistance cylinderDistance(const Vec3f& p, float radius, float halfHeight) {
  const float r = sqrtf(p.x * p.x + p.z * p.z);
  const float up = p.y < 0 ? -1.0f : 1.0f;
  const Point2 q{r - radius, fabsf(p.y) - halfHeight};
  if (q.x > 0 && q.y > 0) {
    const float d = sqrtf(q.x * q.x + q.y * q.y);
    return revolved(p, r, d, {q.x / d, up * q.y / d});
  }
  return q.x > q.y ? revolved(p, r, q.x, {1, 0}) : revolved(p, r, q.y, {0, up});
}

WEIR_HD inline SignedDistance roundDistance(const Vec3f& fromCenter, float radius) {
  const float d = length(fromCenter);
  return {d - radius, d > 0 ? fromCenter / d : Vec3f{0, 1, 0}};
}

WEIR_HD inline SignedDistance coneDistance(const Vec3f& p, float radius, float height) {
  const float r = sqrtf(p.x * p.x + p.z * p.z);
  // The slant runs from (radius, 0) to (0, height) in the half-plane (r, y); its normal points outwards.
  const float slant = sqrtf(radius * radius + height * height);
  const Point2 along{-radius / slant, height / slant}, normal{height / slant, radius / slant};
  const Point2 fromRim{r - radius, p.y};
  const float t = fromRim.x * along.x + fromRim.y * along.y;
  const float beyond = fromRim.x * normal.x + fromRim.y * normal.y;
  if (beyond <= 0 && p.y >= 0) {  // inside: the nearer of slant and base
    return beyond > -p.y ? revolved(p, r, beyond, normal) : revolved(p, r, -p.y, {0, -1});
  }
  const float s = t < 0 ? 0 : (t > slant ? slant : t);
  const Point2 toSlant{fromRim.x - s * along.x, fromRim.y - s * along.y};
  const Point2 toBase{r > radius ? r - radius : 0, p.y};
  const float slantDistance = sqrtf(toSlant.x * toSlant.x + toSlant.y * toSlant.y);
  const float baseDistance = sqrtf(toBase.x * toBase.x + toBase.y * toBase.y);
  if (p.y < 0 && baseDistance <= slantDistance)
    return revolved(p, r, baseDistance, {toBase.x / baseDistance, toBase.y / baseDistance});
  if (slantDistance == 0) return revolved(p, r, 0, normal);
  return revolved(p, r, slantDistance, {toSlant.x / slantDistance, toSlant.y / slantDistance});
}

WEIR_HD inline SignedDistance localDistance(const Shape& s, const Vec3f& p) {
  switch (s.kind) {
    case ShapeKind::kBox:
      return boxDistance(p, s.halfSize);
    case ShapeKind::kSphere:
      return roundDistance(p, s.radius);
    case ShapeKind::kCylinder:
      return cylinderDistance(p, s.radius, 0.5f * s.height);
    case ShapeKind::kCapsule: {
      const float half = 0.5f * s.height;
      const float onAxis = p.y < -half ? -half : (p.y > half ? half : p.y);
      return roundDistance({p.x, p.y - onAxis, p.z}, s.radius);
    }
    case ShapeKind::kCone:
      return coneDistance(p, s.radius, s.height);
    case ShapeKind::kPlane:
      return {p.y, {0, 1, 0}};
  }
  return {};
}

}  // namespace detail

WEIR_HD inline SignedDistance signedDistance(const Shape& shape, const Vec3f& p) {
  SignedDistance d = detail::localDistance(shape, rotate(conjugate(shape.rotation), p - shape.position));
  d.normal = rotate(shape.rotation, d.normal);
  return shape.inverted ? SignedDistance{-d.distance, -d.normal, d.slope} : d;
}

}  // namespace weir
