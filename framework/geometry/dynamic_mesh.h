// A triangle mesh that is another one at every frame, such as the surface of a fluid; on the scene's device.
#pragma once

#include <string_view>

#include "framework/base/api.h"
#include "framework/base/vec.h"
#include "framework/compute/array.h"

namespace WEIR_API weir {

/// Made anew in Node::frame(), so it is right when observers look. All arrays are as long as the mesh.
struct DynamicMesh {
  static constexpr std::string_view kPortType = "DynamicMesh";

  Array<Vec3f> vertices;   ///< m
  Array<Vec3f> normals;    ///< of the vertices, of length 1, outwards
  Array<Vec3i> triangles;  ///< indices of vertices, counter-clockwise seen from outside

  bool empty() const { return triangles.empty(); }
};

}  // namespace weir
