#include "plugins/bodies/bullet_world.h"

#include <BulletCollision/Gimpact/btGImpactCollisionAlgorithm.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "plugins/bodies/bullet_joints.h"
#include "plugins/bodies/contact_points.h"
#include "plugins/bodies/contact_solver.h"
#include "plugins/bodies/detecting_world.h"
#include "plugins/bodies/hull_contacts.h"
#include "plugins/bodies/wall_contacts.h"

namespace weir {

namespace {

constexpr int kIterations = 100;  // at most
// Of the speed below which nothing bounces: iterations end once no contact changes a velocity by more.
constexpr double kConverged = 1e-4;
// Manifolds that are allocated at once; more are allocated one by one.
constexpr std::size_t kPool = 16, kPoolOfBody = 8;

/// Bullet's own pools have room for 4,096 manifolds, which would cost a small world more than its contacts.
btDefaultCollisionConstructionInfo poolsFor(std::size_t bodies) {
  btDefaultCollisionConstructionInfo info;
  const auto usual = static_cast<std::size_t>(info.m_defaultMaxPersistentManifoldPoolSize);
  const auto size = static_cast<int>(std::min(kPool + kPoolOfBody * bodies, usual));
  info.m_defaultMaxPersistentManifoldPoolSize = info.m_defaultMaxCollisionAlgorithmPoolSize = size;
  return info;
}

/// Removing a body looks at all pairs that are left, so pairs go first.
struct AllPairs final : btOverlapCallback {
  bool processOverlap(btBroadphasePair&) override { return true; }
};

/// rad, about its direction.
btVector3 turnBetween(const btTransform& begin, const btTransform& end) {
  btQuaternion q;
  (end.getBasis() * begin.getBasis().transpose()).getRotation(q);
  if (q.w() < 0) q = -q;
  const btVector3 part(q.x(), q.y(), q.z());
  const btScalar sine = part.length();
  return sine > 0 ? part * (2 * std::atan2(sine, q.w()) / sine) : btVector3(0, 0, 0);
}

void moveSolid(btRigidBody& solid, const SolidMotion& by, double share, double dt) {
  const btTransform begin = toBullet(by.begin), end = toBullet(by.end);
  const btVector3 way = end.getOrigin() - begin.getOrigin();
  const btVector3 turn = turnBetween(begin, end);
  btTransform at = begin;
  at.setOrigin(begin.getOrigin() + share * way);
  if (turn.length2() > 0)
    at.setBasis(btMatrix3x3(btQuaternion(turn.normalized(), share * turn.length())) * begin.getBasis());
  solid.setWorldTransform(at);
  solid.setInterpolationWorldTransform(at);
  solid.setLinearVelocity(way / dt);
  solid.setAngularVelocity(turn / dt);
}

/// Bullet keeps each box in its tree with 50 mm around it, for all that there is, so that all neighbours of
/// small bodies were pairs. The same for all worlds, as the order of contacts follows from it.
void narrowTree() {
  constexpr btScalar kMargin = 1e-3;  // m
  static const btScalar once = gDbvtMargin = kMargin;
  (void)once;
}

}  // namespace

struct BulletWorld::Parts {
  Parts(const BulletScene& of, const BodyGroup& with) : scene(of), group(with) {
    broadphase.m_deferedcollide = true;  // where bodies are added is not yet where they are
    fixed.setUserIndex(kWall);
    world.addRigidBody(&fixed, 0, 0);  // meets nothing by itself
    addBodies();
    addSolids();
    joints.emplace(scene, group, moving, fixed);
    joints->addTo(world);
    setSolver();
  }

  ~Parts() {
    AllPairs all;
    world.getPairCache()->processAllOverlappingPairs(&all, &dispatcher);
    joints->removeFrom(world);
    walls.forget();
    for (auto* bodies : {&moving, &still})
      for (auto& body : *bodies) world.removeRigidBody(body.get());
    world.removeRigidBody(&fixed);
  }

  const BulletScene& scene;
  const BodyGroup& group;

  btDefaultCollisionConfiguration configuration{poolsFor(group.bodies.size())};
  btCollisionDispatcher dispatcher{&configuration};
  HullContacts hulls{dispatcher};
  btDbvtBroadphase broadphase;
  ContactSolver solver;
  DetectingWorld world{&dispatcher, &broadphase, &solver, &configuration};
  btSphereShape nothing{1};
  btRigidBody fixed{0, nullptr, &nothing};  // what does not move
  std::vector<std::unique_ptr<btRigidBody>> moving, still;
  std::optional<BulletJoints> joints;
  WallContacts walls{dispatcher, fixed};
  std::vector<char> isHeld;
  // Angular momenta, as Bullet keeps angular velocities, which change as a body turns; and what they were
  // computed from before impulses.
  std::vector<Vec3d> spins;
  std::vector<BodyState> begun;
  double dt = 0, slow = 0;
  const std::vector<KnownContact>* known = nullptr;  // when this part of the step begins
  std::vector<Vec3d> assigned;                       // of these, to Bullet's points

  const HeldBody& held(std::size_t i) const { return scene.held[group.bodies[i]]; }
  const BulletBody& body(std::size_t i) const { return scene.bodies[group.bodies[i]]; }
  /// In the group, by its number in the scene.
  std::size_t indexOf(int k) const {
    return std::size_t(std::lower_bound(group.bodies.begin(), group.bodies.end(), std::size_t(k)) -
                       group.bodies.begin());
  }

  BodyState placeOf(std::size_t i) const {
    BodyState at;
    body(i).setPlace(at, moving[i]->getWorldTransform());
    return at;
  }

  void beginBodies() {
    for (std::size_t i = 0; i < moving.size(); ++i) {
      begun[i] = placeOf(i);
      begun[i].spin = spins[i];
      moving[i]->setAngularVelocity(toBullet(twistOf(held(i).mass, begun[i]).angular));
    }
  }

  void endBodies() {
    for (std::size_t i = 0; i < moving.size(); ++i) {
      const BodyMass& mass = held(i).mass;
      const Vec3d change = fromBullet(moving[i]->getAngularVelocity()) - twistOf(mass, begun[i]).angular;
      const Twist impulse = product(mass.matrix(begun[i].rotation), {{}, change});
      spins[i] += mass.taken({{}, impulse.angular}).angular;
    }
  }

  void addBodies() {
    isHeld.resize(group.bodies.size());
    spins.resize(group.bodies.size());
    begun.resize(group.bodies.size());
    for (std::size_t i = 0; i < group.bodies.size(); ++i) addBody(i);
  }

  void addBody(std::size_t i) {
    const BodyMass& mass = held(i).mass;
    moving.push_back(std::make_unique<btRigidBody>(mass.mass, nullptr, body(i).shape(), body(i).inertia()));
    btRigidBody& added = *moving.back();
    const auto isFree = [&](int bit) { return (mass.locked >> bit & 1) == 0 ? 1.0 : 0.0; };
    added.setLinearFactor({isFree(0), isFree(1), isFree(2)});
    added.setAngularFactor({isFree(3), isFree(4), isFree(5)});
    added.setActivationState(DISABLE_DEACTIVATION);
    added.setUserIndex(int(group.bodies[i]));
    added.setFlags(0);  // its spin is ours
    added.setWorldTransform(body(i).transformOf(held(i).start));
    world.addRigidBody(&added);
  }

  void addSolids() {
    for (const std::size_t k : group.solids) {
      still.push_back(std::make_unique<btRigidBody>(0, nullptr, scene.solids[k].shape.get()));
      still.back()->setUserIndex(kFirstSolid - int(k));
      still.back()->setCollisionFlags(btCollisionObject::CF_KINEMATIC_OBJECT);
      still.back()->setActivationState(DISABLE_DEACTIVATION);
      world.addRigidBody(still.back().get());
    }
  }

  void setSolver() {
    btContactSolverInfo& info = world.getSolverInfo();
    info.m_numIterations = kIterations;
    info.m_minimumSolverBatchSize = 1;  // bodies that touch no others have iterations of their own
    info.m_splitImpulse = 1;
    info.m_splitImpulsePenetrationThreshold = 0;
    info.m_solverMode |= SOLVER_USE_2_FRICTION_DIRECTIONS;
    info.m_warmstartingFactor = 0;  // that is ours
    world.getDispatchInfo().m_deterministicOverlappingPairs = true;
    world.setGravity({0, 0, 0});
    btGImpactCollisionAlgorithm::registerAlgorithm(&dispatcher);
    world.whenDetected = [this] {
      for (std::size_t i = 0; i < moving.size(); ++i) walls.add(*moving[i], body(i), held(i), dt);
      setMaterials(dispatcher, scene.held, fixed, dt, slow);
      if (known != nullptr) assigned = assignImpulses(dispatcher, *known);
    };
  }

  void hold(int k) {
    if (k >= 0) isHeld[indexOf(k)] = 1;
  }
  void markHeld() {
    for (const std::size_t k : group.joints) hold(scene.joints[k].a), hold(scene.joints[k].b);
    forEachTouch(dispatcher, [&](const Touch& touch) {
      if (touch.point.getAppliedImpulse() == 0) return;
      hold(touch.one.getUserIndex());
      hold(touch.two.getUserIndex());
    });
  }
};

BulletWorld::BulletWorld(const BulletScene& scene, const BodyGroup& group) {
  narrowTree();
  parts_ = std::make_unique<Parts>(scene, group);
}

BulletWorld::~BulletWorld() = default;

void BulletWorld::place(std::size_t i, const BodyState& at) {
  btRigidBody& body = *parts_->moving[i];
  body.setCenterOfMassTransform(parts_->body(i).transformOf(at));
  body.setLinearVelocity(toBullet(at.velocity));
  parts_->spins[i] = at.spin;
}

void BulletWorld::moveSolids(const std::vector<SolidMotion>& solidMotions, double share, double dt) {
  for (std::size_t i = 0; i < parts_->still.size(); ++i)
    moveSolid(*parts_->still[i], solidMotions[parts_->group.solids[i]], share, dt);
}

void BulletWorld::doNotBounceBelow(double slow) {
  parts_->slow = slow;
  btContactSolverInfo& info = parts_->world.getSolverInfo();
  info.m_restitutionVelocityThreshold = slow;
  info.m_leastSquaresResidualThreshold = kConverged * slow * kConverged * slow;
}

std::vector<KnownContact> BulletWorld::step(const std::vector<JointDrive>& drives, double dt,
                                            const std::vector<KnownContact>& known) {
  parts_->dt = dt;
  parts_->known = &known;
  parts_->beginBodies();
  parts_->joints->drive(drives, dt);
  parts_->world.stepSimulation(dt, 0);
  parts_->endBodies();
  parts_->markHeld();
  std::vector<KnownContact> found = contactsOf(parts_->dispatcher);
  parts_->walls.forget();
  return found;
}

bool BulletWorld::isHeld(std::size_t i) const {
  return parts_->isHeld[i] != 0;
}

BodyState BulletWorld::stateOf(std::size_t i) const {
  BodyState state = parts_->placeOf(i);
  const SolidImpulse moved =
      parts_->held(i).mass.taken({fromBullet(parts_->moving[i]->getLinearVelocity()), parts_->spins[i]});
  state.velocity = moved.linear;
  state.spin = moved.angular;
  return state;
}

Bounds BulletWorld::boundsOf(std::size_t i) const {
  return weir::boundsOf(*parts_->body(i).shape(), parts_->moving[i]->getWorldTransform());
}

BodyDynamics::Overlap BulletWorld::deepestOverlap() {
  BodyDynamics::Overlap deepest;
  parts_->world.performDiscreteCollisionDetection();
  forEachTouch(parts_->dispatcher, [&](const Touch& touch) {
    if (-touch.point.getDistance() <= deepest.depth) return;
    deepest = {touch.one.getUserIndex(), touch.two.getUserIndex(), -touch.point.getDistance()};
    if (deepest.a < 0) std::swap(deepest.a, deepest.b);
    deepest.b = std::max(deepest.b, -1);
  });
  parts_->walls.forget();
  return deepest;
}

}  // namespace weir
