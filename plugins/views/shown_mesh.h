// A mesh that is another one at each frame, as those who make pictures take it.
#pragma once

#include <span>

#include "framework/base/vec.h"
#include "framework/geometry/dynamic_mesh_copy.h"

namespace weir::rendering {

struct ShownMesh : MeshSpan {
  ShownMesh() = default;
  ShownMesh(const MeshSpan& mesh, std::span<const Vec3f> itsColors = {})
      : MeshSpan(mesh), colors(itsColors) {}

  std::span<const Vec3f> colors;  ///< sRGB from 0 to 1, of each vertex; empty: all have that of the surface
};

}  // namespace weir::rendering
