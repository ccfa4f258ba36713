// Triangles of polygons in space, such as mesh files hold.
#pragma once

#include <span>
#include <vector>

#include "framework/base/api.h"
#include "framework/base/vec.h"

namespace WEIR_API weir {

/// Appends triangles that fill the polygon and are turned like it: those of a fan where it is convex;
/// otherwise corners are cut off one by one. The polygon should be flat and should not cross itself; of any
/// other one the triangles cover something, and there are as many. Nothing is added for fewer than three
/// corners. Throws an io Error for polygons that are not convex and have more corners than can be cut in good
/// time.
void addPolygon(std::span<const int> corners, const std::vector<Vec3f>& vertices,
                std::vector<Vec3i>& triangles);

}  // namespace weir
