#include "plugins/bodies/bullet_shapes.h"

#include <BulletCollision/CollisionShapes/btShapeHull.h>
#include <BulletCollision/Gimpact/btGImpactShape.h>

#include <algorithm>
#include <set>
#include <tuple>
#include <vector>

namespace weir {

namespace {

constexpr double kFlat = 1e-5;            // of the size: how far a point may be off a plane
constexpr double kMargin = 1e-4;          // of the size: Bullet's skin around shapes
constexpr double kSmaller = 1e-3;         // by how much hulls are smaller
constexpr std::size_t kMaxFeatures = 64;  // vertices of hulls of which whole faces are in contact

std::vector<btVector3> verticesOf(const TriangleMesh& mesh, const btTransform& frame) {
  std::set<std::tuple<float, float, float>> seen;
  std::vector<btVector3> vertices;
  for (const Vec3f& v : mesh.vertices)
    if (seen.emplace(v.x, v.y, v.z).second) vertices.push_back(frame * btVector3(v.x, v.y, v.z));
  return vertices;
}

struct Extent {
  btVector3 lo, hi;
  btScalar size() const { return (hi - lo).length(); }
};

Extent extentOf(const std::vector<btVector3>& vertices) {
  Extent of{vertices.front(), vertices.front()};
  for (const btVector3& v : vertices) of.lo.setMin(v), of.hi.setMax(v);
  return of;
}

bool isConvex(const TriangleMesh& mesh, double size) {
  for (const Vec3i& t : mesh.triangles) {
    const auto at = [&](int k) {
      const Vec3f& v = mesh.vertices[std::size_t(k)];
      return btVector3(v.x, v.y, v.z);
    };
    const btVector3 a = at(t.x), normal = (at(t.y) - a).cross(at(t.z) - a);
    if (!(normal.length2() > 0)) continue;
    const btVector3 n = normal.normalized();
    for (int k = 0; k < int(mesh.vertices.size()); ++k)
      if (n.dot(at(k) - a) > kFlat * size) return false;
  }
  return true;
}

std::unique_ptr<btTriangleMesh> trianglesOf(const TriangleMesh& mesh, const btTransform& frame) {
  auto triangles = std::make_unique<btTriangleMesh>();
  const auto at = [&](int k) {
    const Vec3f& v = mesh.vertices[std::size_t(k)];
    return frame * btVector3(v.x, v.y, v.z);
  };
  for (const Vec3i& t : mesh.triangles) triangles->addTriangle(at(t.x), at(t.y), at(t.z));
  return triangles;
}

/// Those farthest along Bullet's 42 directions, which are spread evenly.
std::vector<btVector3> fewOf(const std::vector<btVector3>& vertices) {
  btConvexHullShape hull;
  for (const btVector3& v : vertices) hull.addPoint(v, false);
  hull.recalcLocalAabb();
  hull.setMargin(0);  // it would be added
  btShapeHull few(&hull);
  if (!few.buildHull(0)) return vertices;
  return {few.getVertexPointer(), few.getVertexPointer() + few.numVertices()};
}

/// A convex hull that is smaller by a share than what it stands for.
class SmallerHull final : public btConvexHullShape {
 public:
  SmallerHull(const std::vector<btVector3>& vertices, double margin) {
    setMargin(margin);  // before its box is made, which has the margin around it, 40 mm by default
    const Extent of = extentOf(vertices);
    center_ = 0.5 * (of.lo + of.hi);
    for (const btVector3& v : vertices) addPoint(v + kSmaller * (center_ - v), false);
    recalcLocalAabb();
    if (vertices.size() <= kMaxFeatures) initializePolyhedralFeatures();
  }
  const btVector3& center() const { return center_; }

 private:
  btVector3 center_;
};

}  // namespace

BulletShape shapeOfBody(const TriangleMesh& mesh, const btTransform& frame, bool asHull) {
  const std::vector<btVector3> vertices = verticesOf(mesh, frame);
  const Extent of = extentOf(vertices);
  BulletShape made;
  const double margin = kMargin * of.size();
  if (asHull || isConvex(mesh, of.size())) {
    const bool few = asHull && vertices.size() > kMaxFeatures;
    made.shape = std::make_unique<SmallerHull>(few ? fewOf(vertices) : vertices, margin);
  } else {
    made.triangles = trianglesOf(mesh, frame);
    auto shape = std::make_unique<btGImpactMeshShape>(made.triangles.get());
    shape->setMargin(margin);
    shape->updateBound();
    made.shape = std::move(shape);
  }
  return made;
}

double standsOut(const btCollisionShape& shape, const btTransform& at, const btVector3& point,
                 const btVector3& outwards) {
  if (shape.getShapeType() != CONVEX_HULL_SHAPE_PROXYTYPE) return 0;
  const btVector3 center = at * static_cast<const SmallerHull&>(shape).center();
  return -kSmaller / (1 - kSmaller) * outwards.dot(point - center);
}

BulletShape shapeOfSolid(const TriangleMesh& mesh) {
  const double size = double(length(mesh.bounds().size()));
  if (isConvex(mesh, size)) return shapeOfBody(mesh, btTransform::getIdentity());
  BulletShape made;
  made.triangles = trianglesOf(mesh, btTransform::getIdentity());
  made.shape = std::make_unique<btBvhTriangleMeshShape>(made.triangles.get(), true);
  made.shape->setMargin(kMargin * size);
  return made;
}

}  // namespace weir
