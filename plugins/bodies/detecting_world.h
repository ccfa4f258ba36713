// Bullet's world, with boxes around bodies that are no larger than need be.
#pragma once

#include <btBulletDynamicsCommon.h>

#include <functional>

namespace weir {

class DetectingWorld final : public btDiscreteDynamicsWorld {
 public:
  using btDiscreteDynamicsWorld::btDiscreteDynamicsWorld;
  std::function<void()> whenDetected;  // when contacts are known, and not yet solved

  void performDiscreteCollisionDetection() override;
  /// Velocities of what is moved as told are given.
  void saveKinematicState(btScalar) override {}
  /// Boxes are larger than what is in them by as much as contacts may be apart, which Bullet counts by sizes.
  /// Its own boxes have 20 mm around all that there is, so that all neighbours of small bodies are pairs.
  void updateAabbs() override;
};

}  // namespace weir
