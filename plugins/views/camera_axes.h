// How cameras are turned, and how much they see.
#pragma once

#include <array>

#include "framework/base/vec.h"

namespace weir::rendering {

struct Axes {
  Vec3f right, up, back;  ///< unit vectors
};
/// Axes that look against `back`, with `up` as far up as it can be.
Axes axesOf(const Vec3f& back, const Vec3f& up);

/// The tangent of half the field of view. Throws a scene Error if that is not in (0, 180).
float tangentOfHalf(float fovDegrees);

std::array<Vec3f, 8> cornersOf(const Aabb& box);

}  // namespace weir::rendering
