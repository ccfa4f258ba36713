#include "nodes/emitters/mesh_emitter.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "framework/base/random.h"
#include "framework/geometry/surface_points.h"

namespace weir {

double MeshEmitter::layerSize(float spacing) const {
  const TriangleMesh& mesh = *surface;
  const Aabb box = mesh.bounds();
  const std::string from = "the mesh from '" + surface.links().front()->path() + "'";
  if (mesh.empty() || !isFinite(box.lo) || !isFinite(box.hi) || !(area() > 0))
    throw sceneError(from + " is empty or has no area", "a mesh with a surface");
  const Vec3f far = max(box.hi, -box.lo);
  const double farthest = std::max({far.x, far.y, far.z});
  constexpr double kMaxSpacings = 1e6;  // beyond, single precision moves particles by a tenth of a spacing
  if (farthest > kMaxSpacings * spacing)
    throw sceneError(fmt::format("{} reaches {:.3g} m from the origin, {:.3g} spacings", from, farthest,
                                 farthest / spacing),
                     fmt::format("at most {:.0e} spacings", kMaxSpacings));
  return std::max(1.0, std::round(area() / (double(spacing) * spacing)));
}

Emitter::Layer MeshEmitter::makeLayer(const SetupContext& context, float spacing) const {
  const std::uint64_t number = seedFor(context) ^ hashOf("surface");
  SurfacePoints spread = spreadOverSurface(*surface, static_cast<std::size_t>(layerSize(spacing)), number);
  return {std::move(spread.positions), std::move(spread.normals)};
}

}  // namespace weir
