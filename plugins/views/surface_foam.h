// How white the surface of a fluid is of the foam that lies on it.
#pragma once

#include <span>
#include <vector>

#include "framework/base/vec.h"

namespace weir::rendering {

/// The area pi r^2 of each particle of foam is spread over the surface around it. With
/// K = 3/(pi reach^2) (1 - q^2)^2, whose integral over a plane is 1, sum pi r^2 K is how much of the area
/// around a vertex is covered; above 1 where foam lies in layers.
class SurfaceFoam {
 public:
  /// `reach`: m, above 0.
  SurfaceFoam(std::span<const Vec3f> vertices, float reach)
      : cover(vertices.size()), vertices_(vertices), reach_(reach) {}

  /// Adds what of these particles (m) is foam and near the surface, by its WhiteKind. Returns the radii of
  /// what is left: 0 where it was laid.
  std::vector<float> lay(std::span<const Vec3f> positions, std::span<const float> radii,
                         std::span<const int> kinds);

  std::vector<float> cover;  ///< of each vertex

 private:
  std::span<const Vec3f> vertices_;
  float reach_;
};

}  // namespace weir::rendering
