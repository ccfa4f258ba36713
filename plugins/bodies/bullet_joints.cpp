#include "plugins/bodies/bullet_joints.h"

#include <algorithm>

namespace weir {

namespace {

btTransform frameAt(const Vec3d& origin, const Vec3d& axis, int column) {
  const btVector3 along = toBullet(axis);
  btVector3 one, two;
  btPlaneSpace1(along, one, two);
  const btVector3 of[3] = {along, one, along.cross(one)};
  btMatrix3x3 basis;
  for (int k = 0; k < 3; ++k) {
    const btVector3& v = of[(k - column + 3) % 3];
    for (int row = 0; row < 3; ++row) basis[row][k] = v[row];
  }
  return btTransform(basis, toBullet(origin));
}

void limit(btHingeConstraint& hinge, const std::array<double, 2>& to) {
  constexpr btScalar kSoftness = 1, kBias = 0.3, kBounce = 0;
  hinge.setLimit(to[0], to[1], kSoftness, kBias, kBounce);
}

}  // namespace

BulletJoints::BulletJoints(const BulletScene& scene, const BodyGroup& group,
                           const std::vector<std::unique_ptr<btRigidBody>>& bodies, btRigidBody& fixed)
    : scene_(scene), group_(group), bodies_(bodies), fixed_(fixed) {
  for (const std::size_t k : group.joints) constraints_.push_back(constraintOf(scene.joints[k]));
}

void BulletJoints::addTo(btDynamicsWorld& world) {
  for (auto& constraint : constraints_)
    if (constraint) world.addConstraint(constraint.get(), true);
}

void BulletJoints::removeFrom(btDynamicsWorld& world) {
  for (auto& constraint : constraints_)
    if (constraint) world.removeConstraint(constraint.get());
}

btTransform BulletJoints::startOf(int k) const {
  return k < 0 ? btTransform::getIdentity()
               : scene_.bodies[std::size_t(k)].transformOf(scene_.held[std::size_t(k)].start);
}

btRigidBody& BulletJoints::bodyOf(int k) const {
  if (k < 0) return fixed_;
  const auto at = std::lower_bound(group_.bodies.begin(), group_.bodies.end(), std::size_t(k));
  return *bodies_[std::size_t(at - group_.bodies.begin())];
}

std::unique_ptr<btTypedConstraint> BulletJoints::constraintOf(const HeldJoint& joint) const {
  if (joint.kind == JointKind::kSpring) return nullptr;
  btRigidBody &a = bodyOf(joint.a), &b = bodyOf(joint.b);
  const btTransform frame = frameAt(joint.anchor, joint.axis, joint.kind == JointKind::kSlider ? 0 : 2);
  const btTransform inA = startOf(joint.a).inverse() * frame, inB = startOf(joint.b).inverse() * frame;
  if (joint.kind == JointKind::kHinge) {
    auto hinge = std::make_unique<btHingeConstraint>(a, b, inA, inB);
    if (joint.limits) limit(*hinge, *joint.limits);
    return hinge;
  }
  if (joint.kind == JointKind::kBall)
    return std::make_unique<btPoint2PointConstraint>(a, b, inA.getOrigin(), inB.getOrigin());
  if (joint.kind == JointKind::kFixed) return std::make_unique<btFixedConstraint>(a, b, inA, inB);
  return sliderOf(joint, inA, inB);
}

std::unique_ptr<btTypedConstraint> BulletJoints::sliderOf(const HeldJoint& joint, const btTransform& inA,
                                                          const btTransform& inB) const {
  auto slider = std::make_unique<btSliderConstraint>(bodyOf(joint.a), bodyOf(joint.b), inA, inB, true);
  // Bullet counts how far b is from a; 1 and -1 are none.
  slider->setLowerLinLimit(joint.limits ? -(*joint.limits)[1] : 1);
  slider->setUpperLinLimit(joint.limits ? -(*joint.limits)[0] : -1);
  slider->setLowerAngLimit(0);
  slider->setUpperAngLimit(0);
  return slider;
}

void BulletJoints::drive(const std::vector<JointDrive>& drives, double dt) {
  for (std::size_t i = 0; i < group_.joints.size(); ++i) {
    const HeldJoint& joint = scene_.joints[group_.joints[i]];
    const JointDrive& drive = drives[group_.joints[i]];
    if (joint.kind == JointKind::kSpring)
      pull(joint, dt);
    else if (joint.kind == JointKind::kHinge)
      driveHinge(static_cast<btHingeConstraint&>(*constraints_[i]), joint, drive, dt);
    else if (joint.kind == JointKind::kSlider)
      driveSlider(static_cast<btSliderConstraint&>(*constraints_[i]), joint, drive, dt);
  }
}

void BulletJoints::pull(const HeldJoint& joint, double dt) const {
  btRigidBody &a = bodyOf(joint.a), &b = bodyOf(joint.b);
  const btVector3 onA = a.getWorldTransform() * (startOf(joint.a).inverse() * toBullet(joint.anchor)),
                  onB = b.getWorldTransform() * (startOf(joint.b).inverse() * toBullet(joint.otherAnchor));
  const btVector3 way = onA - onB;
  const btScalar size = way.length();
  if (!(size > 0)) return;
  const btVector3 along = way / size;
  const btVector3 armA = onA - a.getCenterOfMassPosition(), armB = onB - b.getCenterOfMassPosition();
  const btScalar speed = along.dot(a.getVelocityInLocalPoint(armA) - b.getVelocityInLocalPoint(armB));
  const btScalar mobility = a.computeImpulseDenominator(onA, along) + b.computeImpulseDenominator(onB, along);
  const btScalar soft = joint.damping + dt * joint.stiffness;
  const btScalar impulse =
      -dt * (joint.stiffness * (size - joint.length) + soft * speed) / (1 + dt * soft * mobility);
  a.applyImpulse(impulse * along, armA);
  b.applyImpulse(-impulse * along, armB);
}

void BulletJoints::driveHinge(btHingeConstraint& hinge, const HeldJoint& joint, const JointDrive& drive,
                              double dt) const {
  hinge.enableAngularMotor(drive.speed.has_value(), drive.speed.value_or(0), drive.effort * dt);
  if (drive.speed) return;
  const btVector3 torque = drive.effort * dt * axisOf(joint);
  bodyOf(joint.a).applyTorqueImpulse(torque);
  bodyOf(joint.b).applyTorqueImpulse(-torque);
}

void BulletJoints::driveSlider(btSliderConstraint& slider, const HeldJoint& joint, const JointDrive& drive,
                               double dt) const {
  slider.setPoweredLinMotor(drive.speed.has_value());
  slider.setTargetLinMotorVelocity(-drive.speed.value_or(0));  // Bullet's is that of b
  slider.setMaxLinMotorForce(drive.effort);
  if (drive.speed) return;
  const btVector3 push = drive.effort * dt * axisOf(joint);
  bodyOf(joint.a).applyCentralImpulse(push);
  bodyOf(joint.b).applyCentralImpulse(-push);
}

btVector3 BulletJoints::axisOf(const HeldJoint& joint) const {
  return bodyOf(joint.a).getWorldTransform().getBasis() *
         (startOf(joint.a).getBasis().transpose() * toBullet(joint.axis));
}

}  // namespace weir
