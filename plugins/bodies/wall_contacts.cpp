#include "plugins/bodies/wall_contacts.h"

#include <algorithm>

#include "nodes/static_boundary/boundary.h"

namespace weir {

namespace {

constexpr std::size_t kMaxContacts = 64;

btManifoldPoint pointAt(const btVector3& vertex, const btVector3& p, double distance, const btVector3& n) {
  const btVector3 onWall = p - distance * n;
  btManifoldPoint point(vertex, onWall, n, distance);
  point.m_positionWorldOnA = p;
  point.m_positionWorldOnB = onWall;
  return point;
}

/// The nearest first.
std::vector<btManifoldPoint> pointsOf(const btRigidBody& body, const BulletBody& as, const HeldBody& held,
                                      double dt) {
  std::vector<btManifoldPoint> found;
  const btTransform& at = body.getWorldTransform();
  for (const btVector3& vertex : as.vertices()) {
    const btVector3 p = at * vertex;
    const double reach = WallContacts::reachOf(as) +
                         dt * body.getVelocityInLocalPoint(p - body.getCenterOfMassPosition()).length();
    for (const BoundaryPiece& piece : held.walls)
      forEachWall(piece, floatOf(fromBullet(p)), [&](float distance, const Vec3f& normal) {
        if (double(distance) > reach) return;
        found.push_back(pointAt(vertex, p, double(distance), toBullet(doubleOf(normal)).normalized()));
      });
  }
  std::stable_sort(found.begin(), found.end(), [](const btManifoldPoint& a, const btManifoldPoint& b) {
    return a.getDistance() < b.getDistance();
  });
  if (found.size() > kMaxContacts) found.resize(kMaxContacts);
  return found;
}

}  // namespace

double WallContacts::reachOf(const BulletBody& body) {
  constexpr double kReach = 0.02;  // of its radius
  return kReach * body.radius();
}

void WallContacts::add(btRigidBody& body, const BulletBody& as, const HeldBody& held, double dt) {
  int used = MANIFOLD_CACHE_SIZE;
  for (const btManifoldPoint& point : pointsOf(body, as, held, dt)) {
    if (used == MANIFOLD_CACHE_SIZE) {
      manifolds_.push_back(dispatcher_.getNewManifold(&body, &walls_));
      used = 0;
    }
    manifolds_.back()->addManifoldPoint(point);
    ++used;
  }
}

void WallContacts::forget() {
  for (btPersistentManifold* manifold : manifolds_) dispatcher_.releaseManifold(manifold);
  manifolds_.clear();
}

}  // namespace weir
