#include "plugins/bodies/contact_points.h"

#include <algorithm>
#include <cmath>

#include "plugins/bodies/bullet_shapes.h"

namespace weir {

namespace {

/// Between what the shapes stand for.
void measure(const Touch& touch) {
  btManifoldPoint& point = touch.point;
  const auto out = [](const btRigidBody& body, const btVector3& at, const btVector3& outwards) {
    return standsOut(*body.getCollisionShape(), body.getWorldTransform(), at, outwards);
  };
  point.setDistance(point.getDistance() +
                    out(touch.one, point.getPositionWorldOnA(), -point.m_normalWorldOnB) +
                    out(touch.two, point.getPositionWorldOnB(), point.m_normalWorldOnB));
}

void mix(const Touch& touch, const std::vector<HeldBody>& held) {
  const int a = touch.one.getUserIndex(), b = touch.two.getUserIndex();
  const HeldBody &one = held[std::size_t(a >= 0 ? a : b)], &two = held[std::size_t(b >= 0 ? b : a)];
  touch.point.m_combinedFriction = std::sqrt(one.friction * two.friction);
  touch.point.m_combinedRestitution = std::max(one.restitution, two.restitution);
}

/// Bullet takes off a bounce what is left of the way there. So what will meet a wall does so at once; and
/// bodies, of which a single point is known while they are apart, in the next part of the step.
void bounce(const Touch& touch, bool meets, bool atWall, double dt, double slow) {
  constexpr double kFar = 1e9;
  btManifoldPoint& point = touch.point;
  const btScalar approach = -touch.speed();
  if (!meets || approach <= slow || point.getDistance() > 2 * approach * dt)
    point.m_combinedRestitution = 0;
  else if (point.getDistance() > 0 && point.m_combinedRestitution > 0)
    point.setDistance(atWall ? 0 : kFar);
}

/// Where a gap is too small to be meant, its bodies touch: else a body that rests would fall through gaps of
/// a millionth of its size and be thrown back, at speeds that no iteration ends.
void closeGap(const Touch& touch) {
  constexpr double kTouching = 1e-2;  // of what contacts may be apart
  const btScalar apart =
      touch.one.getCollisionShape()->getContactBreakingThreshold(gContactBreakingThreshold);
  if (std::abs(touch.point.getDistance()) < kTouching * apart) touch.point.setDistance(0);
}

}  // namespace

btScalar Touch::speed() const {
  const auto at = [](const btRigidBody& body, const btVector3& p) {
    return body.getVelocityInLocalPoint(p - body.getCenterOfMassPosition());
  };
  return point.m_normalWorldOnB.dot(at(one, point.getPositionWorldOnA()) -
                                    at(two, point.getPositionWorldOnB()));
}

void setMaterials(btDispatcher& dispatcher, const std::vector<HeldBody>& held, const btRigidBody& walls,
                  double dt, double slow) {
  forEachManifold(dispatcher, [&](const std::vector<Touch>& touches) {
    bool meets = false;  // in this part of the step
    for (const Touch& touch : touches) {
      if (&touch.two != &walls) measure(touch);  // of walls, the true vertices are known
      meets = meets || -touch.speed() * dt > touch.point.getDistance();
      mix(touch, held);
    }
    for (const Touch& touch : touches) {
      bounce(touch, meets, &touch.two == &walls, dt, slow);
      closeGap(touch);
    }
  });
}

}  // namespace weir
