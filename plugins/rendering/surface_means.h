// What the particles of a fluid have where its surface is: velocities for motion blur, and colours.
#pragma once

#include <span>
#include <vector>

#include "framework/base/vec.h"

namespace weir::rendering {

/// Of each place (m), the mean of the vectors of the particles within `radius` (m, above 0), with weights
/// (1 - r^2/radius^2)^2; zero where there is none, or the place is not finite. Particles that are not finite
/// are left out. `vectors` has one for each of `positions`.
std::vector<Vec3f> meansAt(std::span<const Vec3f> places, std::span<const Vec3f> positions,
                           std::span<const Vec3f> vectors, float radius);

}  // namespace weir::rendering
