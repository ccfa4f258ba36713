// Analytic solids as something to draw.
#pragma once

#include <vector>

#include "nodes/geometry/triangle_mesh.h"
#include "nodes/static_boundary/shapes.h"
#include "plugins/rendering/view.h"

namespace weir::rendering {

/// The surface of a solid; empty for a plane.
TriangleMesh meshOfShape(const Shape& shape);

/// The edges of a container, or circles around it where it is round; empty for a plane.
std::vector<Line> outlineOfShape(const Shape& shape);

}  // namespace weir::rendering
