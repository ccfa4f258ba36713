// Which particles have no room when they are put into a scene, because there is a solid.
#pragma once

#include <limits>

#include "framework/solids/solid.h"

namespace weir {

/// How near to a solid a particle may start, in spacings.
inline constexpr float kCarveGap = 0.25f;

/// Whether a place lies in a solid as it stands at the end of the step, or closer to it than `gap` (m).
WEIR_HD inline bool hasNoRoom(const SolidView& solid, const Vec3f& position, float gap) {
  const Vec3f p = solid.end.toBody(position);
  // A body's mesh is closed, so there is room wherever its box is not near.
  const Aabb& box = solid.tree.bounds;
  const Vec3f out = p - min(max(p, box.lo), box.hi);
  if (solid.body != nullptr && dot(out, out) > 4 * gap * gap) return false;
  // Only what is near a sheet matters; a side can be far from its surface.
  const float reach = solid.kind == SolidKind::kSheet ? gap : std::numeric_limits<float>::infinity();
  const SurfacePoint nearest = solid.tree.nearest(p, reach);
  if (nearest.triangle < 0) return false;
  if (nearest.distance < gap) return true;
  if (solid.kind == SolidKind::kSheet) return false;
  return (nearest.side < 0) == (solid.kind == SolidKind::kSolid);
}

}  // namespace weir
