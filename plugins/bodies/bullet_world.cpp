#include "plugins/bodies/bullet_world.h"

#include <BulletCollision/Gimpact/btGImpactCollisionAlgorithm.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "nodes/static_boundary/boundary.h"

namespace weir {

namespace {

constexpr int kSolid = -1;       // in place of a body's number
constexpr double kReach = 0.02;  // of a body's radius: how far off walls its contacts are known
constexpr std::size_t kMaxWallContacts = 64;
constexpr int kIterations = 400;  // at most
// Of the speed below which nothing bounces: iterations end once no contact changes a velocity by more.
constexpr double kConverged = 2.5e-5;
// Manifolds that are allocated at once; more are allocated one by one.
constexpr std::size_t kPool = 64, kPoolOfBody = 8;

/// Tells when contacts are known, and not yet solved.
class World final : public btDiscreteDynamicsWorld {
 public:
  using btDiscreteDynamicsWorld::btDiscreteDynamicsWorld;
  std::function<void()> whenDetected;

  void performDiscreteCollisionDetection() override {
    btDiscreteDynamicsWorld::performDiscreteCollisionDetection();
    if (whenDetected) whenDetected();
  }
  /// Velocities of what is moved as told are given.
  void saveKinematicState(btScalar) override {}

  /// Boxes are larger than what is in them by as much as contacts may be apart, which Bullet counts by sizes.
  /// Its own boxes have 20 mm around all that there is, so that all neighbours of small bodies are pairs.
  void updateAabbs() override {
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
};

/// Bullet's own pools have room for 4,096 manifolds, which would cost a small world more than its contacts.
btDefaultCollisionConstructionInfo poolsFor(std::size_t bodies) {
  btDefaultCollisionConstructionInfo info;
  const auto usual = static_cast<std::size_t>(info.m_defaultMaxPersistentManifoldPoolSize);
  const auto room = static_cast<int>(std::min(kPool + kPoolOfBody * bodies, usual));
  info.m_defaultMaxPersistentManifoldPoolSize = info.m_defaultMaxCollisionAlgorithmPoolSize = room;
  return info;
}

/// Removing a body looks at all pairs that are left, so pairs go first.
struct AllPairs final : btOverlapCallback {
  bool processOverlap(btBroadphasePair&) override { return true; }
};

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

btTransform toBullet(const Pose& pose) {
  const auto& [q, t] = pose;
  return btTransform(btQuaternion(q.x, q.y, q.z, q.w), btVector3(t.x, t.y, t.z));
}

/// rad, about its direction.
btVector3 turnBetween(const btTransform& begin, const btTransform& end) {
  btQuaternion q;
  (end.getBasis() * begin.getBasis().transpose()).getRotation(q);
  if (q.w() < 0) q = -q;
  const btVector3 part(q.x(), q.y(), q.z());
  const btScalar sine = part.length();
  return sine > 0 ? part * (2 * std::atan2(sine, q.w()) / sine) : btVector3(0, 0, 0);
}

/// A point of two bodies.
struct Touch {
  btManifoldPoint& point;
  const btRigidBody &one, &two;

  /// Of the first along the normal, away from the second; m/s.
  btScalar speed() const {
    const auto at = [](const btRigidBody& body, const btVector3& p) {
      return body.getVelocityInLocalPoint(p - body.getCenterOfMassPosition());
    };
    return point.m_normalWorldOnB.dot(at(one, point.getPositionWorldOnA()) -
                                      at(two, point.getPositionWorldOnB()));
  }
};

}  // namespace

struct BulletWorld::Parts {
  const std::vector<HeldBody>& held;
  const std::vector<BulletBody>& bodies;
  const std::vector<HeldJoint>& joints;

  btDefaultCollisionConfiguration configuration{poolsFor(bodies.size())};
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  World world{&dispatcher, &broadphase, &solver, &configuration};
  btSphereShape nothing{1};
  btRigidBody fixed{0, nullptr, &nothing};  // what does not move
  std::vector<std::unique_ptr<btRigidBody>> moving, still;
  std::vector<std::unique_ptr<btTypedConstraint>> constraints;  // null for springs
  std::vector<btPersistentManifold*> atWalls;
  std::vector<char> isHeld;
  // Angular momenta, as Bullet keeps angular velocities, which change as a body turns; and what they were
  // computed from before impulses.
  std::vector<Vec3d> spins;
  std::vector<BodyState> begun;
  double dt = 0, slow = 0;

  BodyState placeOf(std::size_t k) const {
    BodyState at;
    bodies[k].setPlace(at, moving[k]->getWorldTransform());
    return at;
  }

  void beginBodies() {
    for (std::size_t k = 0; k < held.size(); ++k) {
      begun[k] = placeOf(k);
      begun[k].spin = spins[k];
      moving[k]->setAngularVelocity(toBullet(twistOf(held[k].mass, begun[k]).angular));
    }
  }

  void endBodies() {
    for (std::size_t k = 0; k < held.size(); ++k) {
      const BodyMass& mass = held[k].mass;
      const Vec3d change = fromBullet(moving[k]->getAngularVelocity()) - twistOf(mass, begun[k]).angular;
      const Twist impulse = product(mass.matrix(begun[k].rotation), {{}, change});
      spins[k] += mass.taken({{}, impulse.angular}).angular;
    }
  }

  void addBodies() {
    spins.resize(held.size());
    begun.resize(held.size());
    for (std::size_t k = 0; k < held.size(); ++k) {
      const BodyMass& mass = held[k].mass;
      moving.push_back(
          std::make_unique<btRigidBody>(mass.mass, nullptr, bodies[k].shape(), bodies[k].inertia()));
      btRigidBody& body = *moving.back();
      const auto isFree = [&](int bit) { return (mass.locked >> bit & 1) == 0 ? 1.0 : 0.0; };
      body.setLinearFactor({isFree(0), isFree(1), isFree(2)});
      body.setAngularFactor({isFree(3), isFree(4), isFree(5)});
      body.setActivationState(DISABLE_DEACTIVATION);
      body.setUserIndex(int(k));
      body.setFlags(0);  // its spin is ours
      body.setWorldTransform(bodies[k].transformOf(held[k].start));
      world.addRigidBody(&body);
    }
  }

  void addSolids(const std::vector<BulletShape>& solids) {
    for (const BulletShape& solid : solids) {
      still.push_back(std::make_unique<btRigidBody>(0, nullptr, solid.shape.get()));
      still.back()->setUserIndex(kSolid);
      still.back()->setCollisionFlags(btCollisionObject::CF_KINEMATIC_OBJECT);
      still.back()->setActivationState(DISABLE_DEACTIVATION);
      world.addRigidBody(still.back().get());
    }
  }

  btTransform startOf(int k) const {
    return k < 0 ? btTransform::getIdentity()
                 : bodies[std::size_t(k)].transformOf(held[std::size_t(k)].start);
  }
  btRigidBody& bodyOf(int k) { return k < 0 ? fixed : *moving[std::size_t(k)]; }

  static void limit(btHingeConstraint& hinge, const std::array<double, 2>& to) {
    constexpr btScalar kSoftness = 1, kBias = 0.3, kBounce = 0;
    hinge.setLimit(to[0], to[1], kSoftness, kBias, kBounce);
  }

  std::unique_ptr<btTypedConstraint> constraintOf(const HeldJoint& joint) {
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
    auto slider = std::make_unique<btSliderConstraint>(a, b, inA, inB, true);
    // Bullet counts how far b is from a; 1 and -1 are none.
    slider->setLowerLinLimit(joint.limits ? -(*joint.limits)[1] : 1);
    slider->setUpperLinLimit(joint.limits ? -(*joint.limits)[0] : -1);
    slider->setLowerAngLimit(0);
    slider->setUpperAngLimit(0);
    return slider;
  }

  void addJoints() {
    for (const HeldJoint& joint : joints) {
      constraints.push_back(constraintOf(joint));
      if (constraints.back()) world.addConstraint(constraints.back().get(), true);
      for (const int k : {joint.a, joint.b})
        if (k >= 0) isHeld[std::size_t(k)] = 1;
    }
  }

  void setSolver() {
    btContactSolverInfo& info = world.getSolverInfo();
    info.m_numIterations = kIterations;
    info.m_minimumSolverBatchSize = 1;  // bodies that touch no others have iterations of their own
    info.m_splitImpulse = 1;
    info.m_splitImpulsePenetrationThreshold = 0;
    info.m_solverMode |= SOLVER_USE_2_FRICTION_DIRECTIONS;
    // What forces have done is all in the velocities of the first part of a step, so later parts are unlike
    // it.
    info.m_warmstartingFactor = 0;
    world.getDispatchInfo().m_deterministicOverlappingPairs = true;
    world.setGravity({0, 0, 0});
    btGImpactCollisionAlgorithm::registerAlgorithm(&dispatcher);
    world.whenDetected = [this] {
      addWalls();
      setMaterials();
    };
  }

  /// Contacts of the body's vertices with walls by signed distance, the nearest first.
  std::vector<btManifoldPoint> wallContacts(std::size_t k) const {
    std::vector<btManifoldPoint> found;
    const btRigidBody& body = *moving[k];
    const btTransform& at = body.getWorldTransform();
    for (const btVector3& vertex : bodies[k].vertices()) {
      const btVector3 p = at * vertex;
      const double reach = kReach * bodies[k].radius() +
                           dt * body.getVelocityInLocalPoint(p - body.getCenterOfMassPosition()).length();
      for (const BoundaryPiece& piece : held[k].walls)
        forEachWall(piece, floatOf(fromBullet(p)), [&](float distance, const Vec3f& normal) {
          if (double(distance) > reach) return;
          const btVector3 n = toBullet(doubleOf(normal)).normalized(), onWall = p - double(distance) * n;
          btManifoldPoint point(vertex, onWall, n, distance);
          point.m_positionWorldOnA = p;
          point.m_positionWorldOnB = onWall;
          found.push_back(point);
        });
    }
    std::stable_sort(found.begin(), found.end(), [](const btManifoldPoint& a, const btManifoldPoint& b) {
      return a.getDistance() < b.getDistance();
    });
    if (found.size() > kMaxWallContacts) found.resize(kMaxWallContacts);
    return found;
  }

  void addWalls() {
    for (std::size_t k = 0; k < held.size(); ++k) {
      int used = MANIFOLD_CACHE_SIZE;
      for (const btManifoldPoint& point : wallContacts(k)) {
        if (used == MANIFOLD_CACHE_SIZE) {
          atWalls.push_back(dispatcher.getNewManifold(moving[k].get(), &fixed));
          used = 0;
        }
        atWalls.back()->addManifoldPoint(point);
        ++used;
      }
    }
  }

  void forgetWalls() {
    for (btPersistentManifold* manifold : atWalls) dispatcher.releaseManifold(manifold);
    atWalls.clear();
  }

  template <class F>
  void forEachManifold(const F& f) {
    for (int m = 0; m < dispatcher.getNumManifolds(); ++m) {
      btPersistentManifold& manifold = *dispatcher.getManifoldByIndexInternal(m);
      std::vector<Touch> touches;
      for (int k = 0; k < manifold.getNumContacts(); ++k)
        touches.push_back({manifold.getContactPoint(k), *btRigidBody::upcast(manifold.getBody0()),
                           *btRigidBody::upcast(manifold.getBody1())});
      f(touches);
    }
  }
  template <class F>
  void forEachTouch(const F& f) {
    forEachManifold([&](const std::vector<Touch>& touches) {
      for (const Touch& touch : touches) f(touch);
    });
  }

  void setMaterials() {
    forEachManifold([&](const std::vector<Touch>& touches) {
      bool meets = false;  // in this part of the step
      for (const Touch& touch : touches) {
        meets = meets || -touch.speed() * dt > touch.point.getDistance();
        mix(touch);
      }
      for (const Touch& touch : touches) bounce(touch, meets);
    });
  }

  void mix(const Touch& touch) {
    const int a = touch.one.getUserIndex(), b = touch.two.getUserIndex();
    const HeldBody &one = held[std::size_t(a >= 0 ? a : b)], &two = held[std::size_t(b >= 0 ? b : a)];
    touch.point.m_combinedFriction = std::sqrt(one.friction * two.friction);
    touch.point.m_combinedRestitution = std::max(one.restitution, two.restitution);
  }

  /// Bullet takes off a bounce what is left of the way there. So what will meet a wall does so at once; and
  /// bodies, of which a single point is known while they are apart, in the next part of the step.
  void bounce(const Touch& touch, bool meets) {
    constexpr double kFar = 1e9;
    btManifoldPoint& point = touch.point;
    const btScalar approach = -touch.speed();
    if (!meets || approach <= slow || point.getDistance() > 2 * approach * dt)
      point.m_combinedRestitution = 0;
    else if (point.getDistance() > 0 && point.m_combinedRestitution > 0)
      point.setDistance(&touch.two == &fixed ? 0 : kFar);
  }

  void markHeld() {
    forEachTouch([&](const Touch& touch) {
      if (touch.point.getAppliedImpulse() == 0) return;
      for (const btRigidBody* body : {&touch.one, &touch.two})
        if (body->getUserIndex() >= 0) isHeld[std::size_t(body->getUserIndex())] = 1;
    });
  }

  /// Implicit in time, so that any stiffness is stable.
  void pull(const HeldJoint& joint) {
    btRigidBody &a = bodyOf(joint.a), &b = bodyOf(joint.b);
    const btVector3 onA = a.getWorldTransform() * (startOf(joint.a).inverse() * toBullet(joint.anchor)),
                    onB = b.getWorldTransform() * (startOf(joint.b).inverse() * toBullet(joint.otherAnchor));
    const btVector3 way = onA - onB;
    const btScalar size = way.length();
    if (!(size > 0)) return;
    const btVector3 along = way / size;
    const btVector3 armA = onA - a.getCenterOfMassPosition(), armB = onB - b.getCenterOfMassPosition();
    const btScalar speed = along.dot(a.getVelocityInLocalPoint(armA) - b.getVelocityInLocalPoint(armB));
    const btScalar mobility =
        a.computeImpulseDenominator(onA, along) + b.computeImpulseDenominator(onB, along);
    const btScalar soft = joint.damping + dt * joint.stiffness;
    const btScalar impulse =
        -dt * (joint.stiffness * (size - joint.length) + soft * speed) / (1 + dt * soft * mobility);
    a.applyImpulse(impulse * along, armA);
    b.applyImpulse(-impulse * along, armB);
  }

  void driveHinge(btHingeConstraint& hinge, const HeldJoint& joint, const JointDrive& drive) {
    hinge.enableAngularMotor(drive.speed.has_value(), drive.speed.value_or(0), drive.effort * dt);
    if (drive.speed) return;
    const btVector3 torque = drive.effort * dt * axisOf(joint);
    bodyOf(joint.a).applyTorqueImpulse(torque);
    bodyOf(joint.b).applyTorqueImpulse(-torque);
  }

  void driveSlider(btSliderConstraint& slider, const HeldJoint& joint, const JointDrive& drive) {
    slider.setPoweredLinMotor(drive.speed.has_value());
    slider.setTargetLinMotorVelocity(-drive.speed.value_or(0));  // Bullet's is that of b
    slider.setMaxLinMotorForce(drive.effort);
    if (drive.speed) return;
    const btVector3 push = drive.effort * dt * axisOf(joint);
    bodyOf(joint.a).applyCentralImpulse(push);
    bodyOf(joint.b).applyCentralImpulse(-push);
  }

  /// As it is now.
  btVector3 axisOf(const HeldJoint& joint) {
    return bodyOf(joint.a).getWorldTransform().getBasis() *
           (startOf(joint.a).getBasis().transpose() * toBullet(joint.axis));
  }

  void drive(std::size_t k, const JointDrive& drive) {
    const HeldJoint& joint = joints[k];
    if (joint.kind == JointKind::kSpring)
      pull(joint);
    else if (joint.kind == JointKind::kHinge)
      driveHinge(static_cast<btHingeConstraint&>(*constraints[k]), joint, drive);
    else if (joint.kind == JointKind::kSlider)
      driveSlider(static_cast<btSliderConstraint&>(*constraints[k]), joint, drive);
  }
};

namespace {

/// Bullet keeps each box in its tree with 50 mm around it, for all that there is, so that all neighbours of
/// small bodies were pairs. The same for all worlds, as the order of contacts follows from it.
void narrowTree() {
  constexpr btScalar kMargin = 1e-3;  // m
  static const btScalar once = gDbvtMargin = kMargin;
  (void)once;
}

}  // namespace

BulletWorld::BulletWorld(const std::vector<HeldBody>& held, const std::vector<BulletBody>& bodies,
                         const std::vector<BulletShape>& solids, const std::vector<HeldJoint>& joints)
    : parts_(std::make_unique<Parts>(held, bodies, joints)) {
  narrowTree();
  parts_->broadphase.m_deferedcollide = true;  // where bodies are added is not yet where they are
  parts_->fixed.setUserIndex(kSolid);
  parts_->world.addRigidBody(&parts_->fixed, 0, 0);  // meets nothing by itself
  parts_->isHeld.assign(held.size(), 0);
  parts_->addBodies();
  parts_->addSolids(solids);
  parts_->addJoints();
  parts_->setSolver();
}

BulletWorld::~BulletWorld() {
  AllPairs all;
  parts_->world.getPairCache()->processAllOverlappingPairs(&all, &parts_->dispatcher);
  for (auto& constraint : parts_->constraints)
    if (constraint) parts_->world.removeConstraint(constraint.get());
  parts_->forgetWalls();
  for (auto* bodies : {&parts_->moving, &parts_->still})
    for (auto& body : *bodies) parts_->world.removeRigidBody(body.get());
  parts_->world.removeRigidBody(&parts_->fixed);
}

void BulletWorld::place(std::size_t k, const BodyState& at) {
  btRigidBody& body = *parts_->moving[k];
  body.setCenterOfMassTransform(parts_->bodies[k].transformOf(at));
  body.setLinearVelocity(toBullet(at.velocity));
  parts_->spins[k] = at.spin;
}

void BulletWorld::moveSolids(const std::vector<SolidWay>& ways, double share, double dt) {
  for (std::size_t k = 0; k < ways.size(); ++k) {
    const btTransform begin = toBullet(ways[k].begin), end = toBullet(ways[k].end);
    const btVector3 way = end.getOrigin() - begin.getOrigin();
    const btVector3 turn = turnBetween(begin, end);
    btRigidBody& solid = *parts_->still[k];
    btTransform at = begin;
    at.setOrigin(begin.getOrigin() + share * way);
    if (turn.length2() > 0)
      at.setBasis(btMatrix3x3(btQuaternion(turn.normalized(), share * turn.length())) * begin.getBasis());
    solid.setWorldTransform(at);
    solid.setInterpolationWorldTransform(at);
    solid.setLinearVelocity(way / dt);
    solid.setAngularVelocity(turn / dt);
  }
}

void BulletWorld::doNotBounceBelow(double slow) {
  parts_->slow = slow;
  btContactSolverInfo& info = parts_->world.getSolverInfo();
  info.m_restitutionVelocityThreshold = slow;
  info.m_leastSquaresResidualThreshold = kConverged * slow * kConverged * slow;
}

void BulletWorld::step(const std::vector<JointDrive>& drives, double dt) {
  parts_->dt = dt;
  parts_->beginBodies();
  for (std::size_t k = 0; k < drives.size(); ++k) parts_->drive(k, drives[k]);
  parts_->world.stepSimulation(dt, 0);
  parts_->endBodies();
  parts_->markHeld();
  parts_->forgetWalls();
}

bool BulletWorld::isHeld(std::size_t k) const {
  return parts_->isHeld[k] != 0;
}

BodyState BulletWorld::stateOf(std::size_t k) const {
  BodyState state = parts_->placeOf(k);
  const SolidImpulse moved =
      parts_->held[k].mass.taken({fromBullet(parts_->moving[k]->getLinearVelocity()), parts_->spins[k]});
  state.velocity = moved.linear;
  state.spin = moved.angular;
  return state;
}

BodyDynamics::Overlap BulletWorld::deepestOverlap() {
  BodyDynamics::Overlap deepest;
  parts_->world.performDiscreteCollisionDetection();
  parts_->forEachTouch([&](const Touch& touch) {
    if (-touch.point.getDistance() <= deepest.depth) return;
    deepest = {touch.one.getUserIndex(), touch.two.getUserIndex(), -touch.point.getDistance()};
    if (deepest.a < 0) std::swap(deepest.a, deepest.b);
  });
  parts_->forgetWalls();
  return deepest;
}

}  // namespace weir
