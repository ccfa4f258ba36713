#include "nodes/box_mesh/box_mesh.h"

#include <fmt/format.h>

namespace weir {

void BoxMesh::validate() const {
  const Vec3f s = size;
  if (!(s.x > 0 && s.y > 0 && s.z > 0))
    throw sceneError(fmt::format("size is [{}, {}, {}]", s.x, s.y, s.z), "three lengths above 0");
}

void BoxMesh::reset(const SetupContext&) {
  TriangleMesh mesh;
  const Vec3f half = 0.5f * size.get();
  for (int i = 0; i < 8; ++i)
    mesh.vertices.push_back({i & 1 ? half.x : -half.x, i & 2 ? half.y : -half.y, i & 4 ? half.z : -half.z});
  // Each face by its corners, counter-clockwise seen from outside.
  constexpr int kFaces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  for (const auto& f : kFaces) {
    mesh.triangles.push_back({f[0], f[1], f[2]});
    mesh.triangles.push_back({f[0], f[2], f[3]});
  }
  mesh.transform(1, rotation->toQuaternion(), position);
  *surface = std::move(mesh);
}

}  // namespace weir
