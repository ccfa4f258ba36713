// Analytic solids as something to draw.
#pragma once

#include <vector>

#include "framework/geometry/shapes.h"
#include "framework/geometry/triangle_mesh.h"

namespace weir::rendering {

/// A line segment, in metres.
struct Line {
  Vec3f from, to;
};

/// The surface of a solid; empty for a plane.
TriangleMesh meshOfShape(const Shape& shape);

/// The edges of a container, or circles around it where it is round; empty for a plane.
std::vector<Line> outlineOfShape(const Shape& shape);

}  // namespace weir::rendering
