// Bullet's world for a group of bodies and one step.
#pragma once

#include <memory>
#include <vector>

#include "nodes/body_contacts/body_dynamics.h"
#include "plugins/bodies/body_groups.h"
#include "plugins/bodies/bullet_scene.h"
#include "plugins/bodies/known_contacts.h"

namespace weir {

class BulletWorld {
 public:
  /// Both must outlive the world.
  BulletWorld(const BulletScene& scene, const BodyGroup& group);
  ~BulletWorld();

  // Bodies are numbered as in the group; solidMotions and drives as solids and joints of the scene.

  /// There, with its velocities.
  void place(std::size_t i, const BodyState& at);
  /// To where they are after that share of a step of `dt` s, with their velocities.
  void moveSolids(const std::vector<SolidMotion>& solidMotions, double share, double dt);
  /// Speeds below this, in m/s.
  void doNotBounceBelow(double slow);
  /// Bodies move without forces but for those of contacts and joints. Begins with what known contacts did;
  /// returns what contacts have done.
  std::vector<KnownContact> step(const std::vector<JointDrive>& drives, double dt,
                                 const std::vector<KnownContact>& known);
  /// Whether it has touched something or has a joint.
  bool isHeld(std::size_t i) const;
  BodyState stateOf(std::size_t i) const;
  Bounds boundsOf(std::size_t i) const;
  BodyDynamics::Overlap deepestOverlap();

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace weir
