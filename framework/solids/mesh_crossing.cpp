#include "framework/solids/mesh_crossing.h"

#include <utility>

#include "framework/geometry/segment_hit.h"

namespace weir {

CrossingMesh::CrossingMesh(TriangleMesh mesh) : mesh_(std::move(mesh)), tree_(host_, mesh_) {}

bool CrossingMesh::crosses(const Pose& at, const CrossingMesh& other, const Pose& otherAt) const {
  return isMetByEdges(at, other, otherAt) || other.isMetByEdges(otherAt, *this, at);
}

bool CrossingMesh::isMetByEdges(const Pose& at, const CrossingMesh& other, const Pose& otherAt) const {
  const TriangleTreeView tree = tree_.view();
  if (tree.empty()) return false;
  std::vector<Vec3f> corners;
  for (const Vec3f& vertex : other.mesh_.vertices) corners.push_back(at.toBody(otherAt.toWorld(vertex)));
  const auto meets = [&](const Vec3f& p, const Vec3f& q) {
    Aabb around;
    around.extend(p);
    around.extend(q);
    for (int axis = 0; axis < 3; ++axis)
      if (around.hi[axis] < tree.bounds.lo[axis] || around.lo[axis] > tree.bounds.hi[axis]) return false;
    return firstHit(tree, p, q).found();
  };
  for (const auto& triangle : other.mesh_.triangles)
    for (int k = 0; k < 3; ++k)
      if (meets(corners[triangle[k]], corners[triangle[(k + 1) % 3]])) return true;
  return false;
}

}  // namespace weir
