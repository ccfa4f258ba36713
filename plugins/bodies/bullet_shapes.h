// Bullet's shapes for meshes.
#pragma once

#include <btBulletDynamicsCommon.h>

#include <memory>

#include "framework/base/vec.h"
#include "framework/geometry/triangle_mesh.h"
#include "framework/solids/pose.h"

namespace weir {

inline btVector3 toBullet(const Vec3d& v) {
  return {v.x, v.y, v.z};
}
inline Vec3d fromBullet(const btVector3& v) {
  return {v.x(), v.y(), v.z()};
}

inline btTransform toBullet(const Pose& pose) {
  const auto& [q, t] = pose;
  return btTransform(btQuaternion(q.x, q.y, q.z, q.w), btVector3(t.x, t.y, t.z));
}

/// With the triangles that it refers to.
struct BulletShape {
  std::unique_ptr<btTriangleMesh> triangles;
  std::unique_ptr<btCollisionShape> shape;
};

/// By how much the shape at that place stands out over what it stands for, at a point of its surface, m.
/// Hulls are smaller by a thousandth, as Bullet finds the direction between hulls that are apart more
/// exactly, and faster, than that between those that overlap or just touch. `outwards` is of length 1.
double standsOut(const btCollisionShape& shape, const btTransform& at, const btVector3& point,
                 const btVector3& outwards);

/// Of a body: a convex hull, or else the triangles themselves; if `asHull`, a coarse hull of any mesh.
/// `frame` takes points of the mesh to points of the shape.
BulletShape shapeOfBody(const TriangleMesh& mesh, const btTransform& frame, bool asHull = false);
/// Of a solid that does not move.
BulletShape shapeOfSolid(const TriangleMesh& mesh);

}  // namespace weir
