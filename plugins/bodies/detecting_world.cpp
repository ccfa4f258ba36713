#include "plugins/bodies/detecting_world.h"

namespace weir {

void DetectingWorld::performDiscreteCollisionDetection() {
  btDiscreteDynamicsWorld::performDiscreteCollisionDetection();
  if (whenDetected) whenDetected();
}

void DetectingWorld::updateAabbs() {
  constexpr btScalar kTooLarge = 1e12;  // m²
  for (int k = 0; k < m_collisionObjects.size(); ++k) {
    const btCollisionObject& object = *m_collisionObjects[k];
    const btCollisionShape& shape = *object.getCollisionShape();
    btVector3 lo, hi, lastLo, lastHi;
    shape.getAabb(object.getWorldTransform(), lo, hi);
    if (!object.isStaticOrKinematicObject()) {
      shape.getAabb(object.getInterpolationWorldTransform(), lastLo, lastHi);
      lo.setMin(lastLo);
      hi.setMax(lastHi);
    }
    // As Bullet does with what is too large, or not a number.
    if (!((hi - lo).length2() < kTooLarge)) continue;
    const btScalar apart = shape.getContactBreakingThreshold(gContactBreakingThreshold);
    const btVector3 skin(apart, apart, apart);
    m_broadphasePairCache->setAabb(m_collisionObjects[k]->getBroadphaseHandle(), lo - skin, hi + skin,
                                   m_dispatcher1);
  }
}

}  // namespace weir
