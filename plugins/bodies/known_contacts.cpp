#include "plugins/bodies/known_contacts.h"

#include <algorithm>
#include <cstdint>
#include <span>
#include <tuple>

#include "plugins/bodies/bullet_shapes.h"
#include "plugins/bodies/contact_points.h"

namespace weir {

namespace {

bool isBefore(const KnownContact& one, const KnownContact& two) {
  return std::tie(one.a, one.b) < std::tie(two.a, two.b);
}

/// A point of Bullet's, of two bodies.
struct FoundPoint {
  std::int64_t a, b;
  btManifoldPoint* point;
};

/// In the order of known contacts. Two bodies may have several manifolds.
std::vector<FoundPoint> pointsOf(btDispatcher& dispatcher) {
  std::vector<FoundPoint> points;
  forEachTouch(dispatcher, [&](const Touch& touch) {
    points.push_back({numberOf(touch.one), numberOf(touch.two), &touch.point});
  });
  std::stable_sort(points.begin(), points.end(), [](const FoundPoint& one, const FoundPoint& two) {
    return std::tie(one.a, one.b) < std::tie(two.a, two.b);
  });
  return points;
}

/// The nearest point that faces the same way; null if none does.
btManifoldPoint* nearest(const KnownContact& known, std::span<const FoundPoint> points) {
  constexpr double kSameWay = 0.9;
  btManifoldPoint* found = nullptr;
  btScalar nearestYet = SIMD_INFINITY;
  for (const FoundPoint& of : points) {
    const btScalar off = (toBullet(known.at) - of.point->m_localPointA).length2();
    if (off > nearestYet || toBullet(known.normal).dot(of.point->m_normalWorldOnB) < kSameWay) continue;
    found = of.point;
    nearestYet = off;
  }
  return found;
}

/// On the first body.
btVector3 impulseOf(const btManifoldPoint& point) {
  return point.m_appliedImpulse * point.m_normalWorldOnB +
         point.m_appliedImpulseLateral1 * point.m_lateralFrictionDir1 +
         point.m_appliedImpulseLateral2 * point.m_lateralFrictionDir2;
}

}  // namespace

void sortByBodies(std::vector<KnownContact>& contacts) {
  std::stable_sort(contacts.begin(), contacts.end(), isBefore);
}

std::vector<Vec3d> assignImpulses(btDispatcher& dispatcher, const std::vector<KnownContact>& known) {
  std::vector<Vec3d> impulses;
  impulses.reserve(known.size());  // points keep where they are
  const std::vector<FoundPoint> points = pointsOf(dispatcher);
  for (const FoundPoint& of : points) of.point->m_userPersistentData = nullptr;
  auto begin = points.begin();
  for (const KnownContact& of : known) {
    const auto isBefore = [&](const FoundPoint& p) { return std::tie(p.a, p.b) < std::tie(of.a, of.b); };
    begin = std::find_if_not(begin, points.end(), isBefore);
    const auto end = std::find_if(
        begin, points.end(), [&](const FoundPoint& p) { return std::tie(p.a, p.b) != std::tie(of.a, of.b); });
    btManifoldPoint* point = nearest(of, std::span(begin, end));
    if (point == nullptr) continue;
    if (point->m_userPersistentData == nullptr) point->m_userPersistentData = &impulses.emplace_back();
    *static_cast<Vec3d*>(point->m_userPersistentData) += of.impulse;
  }
  return impulses;
}

const Vec3d* assignedImpulse(const btManifoldPoint& point) {
  return static_cast<const Vec3d*>(point.m_userPersistentData);
}

std::vector<KnownContact> contactsOf(btDispatcher& dispatcher) {
  std::vector<KnownContact> contacts;
  forEachTouch(dispatcher, [&](const Touch& touch) {
    const btManifoldPoint& point = touch.point;
    if (!(point.getAppliedImpulse() > 0)) return;
    contacts.push_back({.a = numberOf(touch.one),
                        .b = numberOf(touch.two),
                        .at = fromBullet(point.m_localPointA),
                        .normal = fromBullet(point.m_normalWorldOnB),
                        .impulse = fromBullet(impulseOf(point))});
  });
  return contacts;
}

}  // namespace weir
