// Boxes that tell quickly that a point is far from a solid.
#pragma once

#include <optional>

#include "framework/geometry/shapes.h"

namespace weir {

/// An axis-aligned box that holds the solid; where the solid is inverted, one that lies in its room. A point
/// outside of the former or inside of the latter is at least as far from the solid as from the box's surface.
/// Nothing of planes and of inverted cones.
std::optional<Aabb> boundsOf(const Shape& shape);

}  // namespace weir
