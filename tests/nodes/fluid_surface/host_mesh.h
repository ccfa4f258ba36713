// What tests ask of a mesh on a device.
#pragma once

#include <numeric>
#include <set>
#include <vector>

#include "framework/geometry/dynamic_mesh.h"
#include "framework/geometry/triangle_mesh.h"

namespace weir::test {

inline TriangleMesh onHost(const DynamicMesh& mesh) {
  return {mesh.vertices.toHost(), mesh.triangles.toHost()};
}

/// How many pieces the triangles hang together in.
inline int components(const TriangleMesh& mesh) {
  std::vector<int> parent(mesh.vertices.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const Vec3i& t : mesh.triangles) parent[root(t.x)] = parent[root(t.y)] = root(t.z);
  std::set<int> roots;
  for (const Vec3i& t : mesh.triangles) roots.insert(root(t.x));
  return static_cast<int>(roots.size());
}

/// Vertices − edges + triangles of a closed mesh all of whose vertices are used: 2 for each ball.
inline std::int64_t eulerCharacteristic(const TriangleMesh& mesh) {
  const auto triangles = std::ssize(mesh.triangles);
  return std::ssize(mesh.vertices) - triangles * 3 / 2 + triangles;
}

}  // namespace weir::test
