#include "plugins/bodies/known_contacts.h"

#include <algorithm>
#include <tuple>

#include "plugins/bodies/bullet_shapes.h"
#include "plugins/bodies/contact_points.h"

namespace weir {

namespace {

bool isBefore(const KnownContact& one, const KnownContact& two) {
  return std::tie(one.a, one.b) < std::tie(two.a, two.b);
}

/// The nearest that faces the same way, at most as far off as contacts may be apart.
const KnownContact* nearest(const Touch& touch, const std::vector<KnownContact>& known) {
  constexpr double kSameWay = 0.9;
  KnownContact wanted;
  wanted.a = numberOf(touch.one), wanted.b = numberOf(touch.two);
  const auto [begin, end] = std::equal_range(known.begin(), known.end(), wanted, isBefore);
  const KnownContact* found = nullptr;
  const btScalar apart =
      touch.one.getCollisionShape()->getContactBreakingThreshold(gContactBreakingThreshold);
  btScalar nearestYet = apart * apart;
  for (auto k = begin; k != end; ++k) {
    const btScalar off = (toBullet(k->at) - touch.point.m_localPointA).length2();
    if (off > nearestYet || toBullet(k->normal).dot(touch.point.m_normalWorldOnB) < kSameWay) continue;
    found = &*k;
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

void recognise(btDispatcher& dispatcher, const std::vector<KnownContact>& known) {
  forEachTouch(dispatcher, [&](const Touch& touch) {
    touch.point.m_userPersistentData = const_cast<KnownContact*>(nearest(touch, known));
  });
}

const KnownContact* knownAs(const btManifoldPoint& point) {
  return static_cast<const KnownContact*>(point.m_userPersistentData);
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
