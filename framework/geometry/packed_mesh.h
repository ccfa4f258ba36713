// A mesh as bytes, for readers that work in a process of their own.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>

#include "framework/base/error.h"
#include "framework/base/packed.h"
#include "framework/geometry/triangle_mesh.h"

namespace weir {

inline std::string packed(const TriangleMesh& mesh) {
  Packer packer;
  packer.addAll(mesh.vertices);
  packer.addAll(mesh.triangles);
  return packer.take();
}

/// Believes nothing, as a damaged file may have upset the process that packed it.
inline TriangleMesh unpacked(std::string_view bytes) {
  Unpacker unpacker(bytes);
  TriangleMesh mesh{.vertices = unpacker.all<Vec3f>(), .triangles = unpacker.all<Vec3i>()};
  const auto count = static_cast<std::int64_t>(mesh.vertices.size());
  const auto there = [&](int vertex) { return vertex >= 0 && vertex < count; };
  const bool good = std::all_of(mesh.triangles.begin(), mesh.triangles.end(),
                                [&](const Vec3i& t) { return there(t.x) && there(t.y) && there(t.z); });
  if (!good) throw ioError("the file is damaged: its contents are inconsistent");
  return mesh;
}

}  // namespace weir
