// Bullet's world for one step.
#pragma once

#include <memory>
#include <vector>

#include "nodes/body_contacts/body_dynamics.h"
#include "plugins/bodies/bullet_body.h"

namespace weir {

class BulletWorld {
 public:
  BulletWorld(const std::vector<HeldBody>& held, const std::vector<BulletBody>& bodies,
              const std::vector<BulletShape>& solids, const std::vector<HeldJoint>& joints);
  ~BulletWorld();

  /// There, with its velocities.
  void place(std::size_t k, const BodyState& at);
  /// To where they are after that share of a step of `dt` s, with their velocities.
  void moveSolids(const std::vector<SolidWay>& ways, double share, double dt);
  /// Speeds below this, in m/s.
  void doNotBounceBelow(double slow);
  /// Bodies move without forces but for those of contacts and joints.
  void step(const std::vector<JointDrive>& drives, double dt);
  /// Whether it has touched something or has a joint.
  bool isHeld(std::size_t k) const;
  BodyState stateOf(std::size_t k) const;
  BodyDynamics::Overlap deepestOverlap();

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace weir
