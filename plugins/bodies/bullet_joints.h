// Joints of a group of bodies, as Bullet's constraints, and what drives them. Springs are impulses of ours.
#pragma once

#include <btBulletDynamicsCommon.h>

#include <memory>
#include <vector>

#include "plugins/bodies/bullet_scene.h"

namespace weir {

class BulletJoints {
 public:
  /// `bodies` are those of the group; `fixed` does not move. All must outlive the joints.
  BulletJoints(const BulletScene& scene, const BodyGroup& group,
               const std::vector<std::unique_ptr<btRigidBody>>& bodies, btRigidBody& fixed);

  void addTo(btDynamicsWorld& world);
  void removeFrom(btDynamicsWorld& world);
  /// Before a part of a step of `dt` s. Drives are those of all joints of the scene.
  void drive(const std::vector<JointDrive>& drives, double dt);

 private:
  btTransform startOf(int k) const;
  /// By its number in the scene.
  btRigidBody& bodyOf(int k) const;
  std::unique_ptr<btTypedConstraint> constraintOf(const HeldJoint& joint) const;
  std::unique_ptr<btTypedConstraint> sliderOf(const HeldJoint& joint, const btTransform& inA,
                                              const btTransform& inB) const;
  /// As it is now.
  btVector3 axisOf(const HeldJoint& joint) const;
  /// Implicit in time, so that any stiffness is stable.
  void pull(const HeldJoint& joint, double dt) const;
  void driveHinge(btHingeConstraint& hinge, const HeldJoint& joint, const JointDrive& drive, double dt) const;
  void driveSlider(btSliderConstraint& slider, const HeldJoint& joint, const JointDrive& drive,
                   double dt) const;

  const BulletScene& scene_;
  const BodyGroup& group_;
  const std::vector<std::unique_ptr<btRigidBody>>& bodies_;
  btRigidBody& fixed_;
  std::vector<std::unique_ptr<btTypedConstraint>> constraints_;  // of the group's joints; null for springs
};

}  // namespace weir
