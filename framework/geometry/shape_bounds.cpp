#include "framework/geometry/shape_bounds.h"

#include <algorithm>
#include <cmath>

namespace weir {

namespace {

Aabb around(const Vec3f& center, const Vec3f& half) {
  return {center - half, center + half};
}

/// In the shape's own frame.
std::optional<Aabb> localBounds(const Shape& s) {
  const float half = 0.5f * s.height;
  switch (s.kind) {
    case ShapeKind::kBox:
      return around({}, s.halfSize);
    case ShapeKind::kSphere:
      return around({}, {s.radius, s.radius, s.radius});
    case ShapeKind::kCylinder:
      return around({}, {s.radius, half, s.radius});
    case ShapeKind::kCapsule:
      return around({}, {s.radius, half + s.radius, s.radius});
    case ShapeKind::kCone:
      return Aabb{{-s.radius, 0, -s.radius}, {s.radius, s.height, s.radius}};
    case ShapeKind::kPlane:
      break;
  }
  return std::nullopt;
}

/// The same for a box in the room of the shape's surface.
std::optional<Aabb> localRoom(const Shape& s) {
  const float inCircle = s.radius / std::sqrt(2.0f), inSphere = s.radius / std::sqrt(3.0f);
  switch (s.kind) {
    case ShapeKind::kBox:
      return around({}, s.halfSize);
    case ShapeKind::kSphere:
      return around({}, {inSphere, inSphere, inSphere});
    case ShapeKind::kCylinder:
    case ShapeKind::kCapsule:
      return around({}, {inCircle, 0.5f * s.height, inCircle});
    case ShapeKind::kCone:
    case ShapeKind::kPlane:
      break;
  }
  return std::nullopt;
}

bool isTurned(const Shape& s) {
  return s.rotation.x != 0 || s.rotation.y != 0 || s.rotation.z != 0;
}

Aabb placed(const Aabb& local, const Shape& s) {
  if (!isTurned(s)) return {s.position + local.lo, s.position + local.hi};
  Aabb result;
  for (int corner = 0; corner < 8; ++corner)
    result.extend(s.position + rotate(s.rotation, {(corner & 1) != 0 ? local.hi.x : local.lo.x,
                                                   (corner & 2) != 0 ? local.hi.y : local.lo.y,
                                                   (corner & 4) != 0 ? local.hi.z : local.lo.z}));
  return result;
}

/// The largest box with these proportions, aligned with the axes, in one that is turned.
Aabb alignedIn(const Aabb& local, const Shape& s) {
  const Vec3f half = 0.5f * local.size();
  const Vec3f x = rotate(s.rotation, {1, 0, 0}), y = rotate(s.rotation, {0, 1, 0}),
              z = rotate(s.rotation, {0, 0, 1});
  const auto reach = [&](const Vec3f& axis) {
    return std::abs(axis.x) * half.x + std::abs(axis.y) * half.y + std::abs(axis.z) * half.z;
  };
  const float scale = std::min({half.x / reach(x), half.y / reach(y), half.z / reach(z)});
  return around(s.position, scale * half);
}

}  // namespace

std::optional<Aabb> boundsOf(const Shape& shape) {
  const std::optional<Aabb> local = shape.inverted ? localRoom(shape) : localBounds(shape);
  if (!local) return std::nullopt;
  return shape.inverted && isTurned(shape) ? alignedIn(*local, shape) : placed(*local, shape);
}

}  // namespace weir
