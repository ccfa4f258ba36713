#include "plugins/bodies/hull_contacts.h"

#include <BulletCollision/CollisionDispatch/btActivatingCollisionAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkEpaPenetrationDepthSolver.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkPairDetector.h>
#include <BulletCollision/NarrowPhaseCollision/btPointCollector.h>
#include <BulletCollision/NarrowPhaseCollision/btPolyhedralContactClipping.h>
#include <BulletCollision/NarrowPhaseCollision/btVoronoiSimplexSolver.h>
#include <btBulletCollisionCommon.h>

#include <new>

namespace weir {

namespace {

const btConvexHullShape& hullOf(const btCollisionObjectWrapper& of) {
  return *static_cast<const btConvexHullShape*>(of.getCollisionShape());
}

/// Without margins.
struct Nearest {
  bool found = false;
  btVector3 normal, onTwo;  // the normal is towards the first
  btScalar distance = 0;
};

Nearest nearestOf(const btCollisionObjectWrapper& one, const btCollisionObjectWrapper& two, btScalar reach) {
  const btConvexHullShape &a = hullOf(one), &b = hullOf(two);
  const btScalar margins = a.getMargin() + b.getMargin();
  btVoronoiSimplexSolver simplex;
  btGjkEpaPenetrationDepthSolver depths;
  btGjkPairDetector detector(&a, &b, &simplex, &depths);
  btGjkPairDetector::ClosestPointInput input;
  input.m_transformA = one.getWorldTransform();
  input.m_transformB = two.getWorldTransform();
  input.m_maximumDistanceSquared = (margins + reach) * (margins + reach);
  btPointCollector collected;
  detector.getClosestPoints(input, collected, nullptr);
  if (!collected.m_hasResult) return {};
  const btVector3& normal = collected.m_normalOnBInWorld;
  return {true, normal, collected.m_pointInWorld - b.getMargin() * normal, collected.m_distance + margins};
}

/// Those of hulls with few vertices are known.
bool haveFaces(const btCollisionObjectWrapper& one, const btCollisionObjectWrapper& two) {
  return hullOf(one).getConvexPolyhedron() != nullptr && hullOf(two).getConvexPolyhedron() != nullptr;
}

/// Adds the points of the faces that meet there.
void addFaces(const btCollisionObjectWrapper& one, const btCollisionObjectWrapper& two, const Nearest& at,
              btScalar reach, btManifoldResult& result) {
  btVertexArray once, twice;
  btPolyhedralContactClipping::clipHullAgainstHull(
      at.normal, *hullOf(one).getConvexPolyhedron(), *hullOf(two).getConvexPolyhedron(),
      one.getWorldTransform(), two.getWorldTransform(), at.distance - reach, reach, once, twice, result);
}

class Hulls final : public btActivatingCollisionAlgorithm {
 public:
  Hulls(const btCollisionAlgorithmConstructionInfo& info, const btCollisionObjectWrapper* one,
        const btCollisionObjectWrapper* two)
      : btActivatingCollisionAlgorithm(info, one, two) {}
  ~Hulls() override {
    if (manifold_ != nullptr) m_dispatcher->releaseManifold(manifold_);
  }

  void processCollision(const btCollisionObjectWrapper* one, const btCollisionObjectWrapper* two,
                        const btDispatcherInfo&, btManifoldResult* result) override {
    if (manifold_ == nullptr)
      manifold_ = m_dispatcher->getNewManifold(one->getCollisionObject(), two->getCollisionObject());
    result->setPersistentManifold(manifold_);
    add(*one, *two, *result);
  }

  btScalar calculateTimeOfImpact(btCollisionObject*, btCollisionObject*, const btDispatcherInfo&,
                                 btManifoldResult*) override {
    return 1;
  }

  void getAllContactManifolds(btManifoldArray& manifolds) override {
    if (manifold_ != nullptr) manifolds.push_back(manifold_);
  }

 private:
  void add(const btCollisionObjectWrapper& one, const btCollisionObjectWrapper& two,
           btManifoldResult& result) {
    const btScalar reach = manifold_->getContactBreakingThreshold();
    const Nearest at = nearestOf(one, two, reach);
    const bool faces = haveFaces(one, two);
    if (faces) manifold_->clearManifold();
    if (faces && at.found) addFaces(one, two, at, reach, result);
    if (at.found && (!faces || manifold_->getNumContacts() == 0))
      result.addContactPoint(at.normal, at.onTwo, at.distance);
    if (!faces) result.refreshContactPoints();  // they gather from one part of a step to the next
  }

  btPersistentManifold* manifold_ = nullptr;
};

}  // namespace

HullContacts::HullContacts(btCollisionDispatcher& dispatcher) {
  dispatcher.registerCollisionCreateFunc(CONVEX_HULL_SHAPE_PROXYTYPE, CONVEX_HULL_SHAPE_PROXYTYPE, this);
}

btCollisionAlgorithm* HullContacts::CreateCollisionAlgorithm(btCollisionAlgorithmConstructionInfo& info,
                                                             const btCollisionObjectWrapper* one,
                                                             const btCollisionObjectWrapper* two) {
  return new (info.m_dispatcher1->allocateCollisionAlgorithm(sizeof(Hulls))) Hulls(info, one, two);
}

}  // namespace weir
