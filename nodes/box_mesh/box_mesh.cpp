#include "nodes/box_mesh/box_mesh.h"

#include <fmt/format.h>

namespace weir {

void BoxMesh::validate() const {
  const Vec3f size = max.get() - min.get();
  if (!(size.x > 0 && size.y > 0 && size.z > 0))
    throw sceneError(fmt::format("the box has sides of {} x {} x {} m", size.x, size.y, size.z),
                     "max above min along every axis")
        .inParameter(max.name());
}

void BoxMesh::reset(const SetupContext&) {
  // Vertex i lies above the centre along x, y and z where bits 0, 1 and 2 of i are set.
  const Vec3f centre = 0.5f * (min.get() + max.get()), half = 0.5f * (max.get() - min.get());
  surface->vertices.clear();
  for (int i = 0; i < 8; ++i)
    surface->vertices.push_back(
        {i & 1 ? half.x : -half.x, i & 2 ? half.y : -half.y, i & 4 ? half.z : -half.z});
  surface->triangles.clear();
  for (int axis = 0; axis < 3; ++axis) {
    const int a = 1 << axis, b = 1 << (axis + 1) % 3, c = 1 << (axis + 2) % 3;
    const std::vector<Vec3i> sides{{0, c, b}, {b, c, b + c}, {a, a + b, a + c}, {a + b, a + b + c, a + c}};
    surface->triangles.insert(surface->triangles.end(), sides.begin(), sides.end());
  }
  surface->transform(1, rotation->toQuaternion(), centre);
}

}  // namespace weir
