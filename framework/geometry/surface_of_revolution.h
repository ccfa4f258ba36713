// Surfaces of revolution: what a lathe makes of a profile, as a closed triangle mesh.
#pragma once

#include <optional>
#include <vector>

#include "framework/base/api.h"
#include "framework/geometry/triangle_mesh.h"

namespace WEIR_API weir {

/// A polyline in the half plane (radius, height) that is turned about the y axis.
struct Outline {
  struct Point {
    double radius = 0, height = 0;  // m
  };
  std::vector<Point> points;  ///< counter-clockwise: the material is on the left
  bool closed = true;         ///< the last point is joined to the first
};

struct RevolutionOptions {
  /// Joins the ends of an open profile to the axis by discs. Without it, and without a thickness, the surface
  /// is open; its normals then point away from where the discs would close it.
  bool caps = true;
  /// Makes a wall of this thickness (m) out of an open profile, which becomes the wall's outer side. Corners
  /// are mitred, or cut off square where the mitre would be longer than twice the thickness. The rim is
  /// square to the profile. A flat profile, which has no inside, gets its wall on its left.
  std::optional<double> thickness;
};

/// The line that is turned, from a profile of [radius, height] points. The profile may run either way, and
/// may be closed (its last point is its first) or end on the axis. Points closer to the axis than a
/// millionth of the profile's size are on it. Throws a scene Error that names the point for: fewer than 2
/// different points, a negative or non-finite number, a point on the axis between the ends, nothing off the
/// axis, a line that crosses or touches itself, a profile without an inside, a thickness that does not fit.
Outline revolutionOutline(const std::vector<Vec2f>& profile, const RevolutionOptions& options);

/// Turns the outline in `segments` steps (at least 3). Points on the axis become one vertex each. The n-gons
/// have their corners on the circles, so that volumes are those of the circles times
/// sin(2π/segments)·segments/(2π). Triangles are counter-clockwise seen from outside.
TriangleMesh surfaceOfRevolution(const Outline& outline, int segments);

}  // namespace weir
