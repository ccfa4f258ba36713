// Arrows that show how a fluid moves.
#pragma once

#include <span>
#include <vector>

#include "plugins/views/frame_kernels.h"

namespace weir::rendering {

/// Adds an arrow for each cube of the edge `spacing` [m] that holds particles which no cut hides: from their
/// mean place along their mean velocity, as far as that goes in `seconds`, as three lines of two points each.
/// Arrows are moved towards `eye` by one spacing, where they look the same, so that the fluid that they
/// belong to does not hide them. Cubes in which nothing moves have no arrow; particles that are not finite do
/// not count. The order of the particles does not matter but for rounding.
void addVelocityArrows(std::span<const Vec3f> positions, std::span<const Vec3f> velocities,
                       std::span<const Cut> cuts, float spacing, float seconds, const Vec3f& eye,
                       std::vector<Vec3f>& lines);

}  // namespace weir::rendering
