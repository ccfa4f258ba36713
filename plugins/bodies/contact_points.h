// The contacts that Bullet has found, with what bodies are made of.
#pragma once

#include <btBulletDynamicsCommon.h>

#include <vector>

#include "nodes/body_contacts/body_dynamics.h"

namespace weir {

// User indices: a body has its number in the scene; what is none has kWall, or kFirstSolid - its number.
constexpr int kWall = -1, kFirstSolid = -2;

/// A point of two bodies.
struct Touch {
  btManifoldPoint& point;
  const btRigidBody &one, &two;

  /// Of the first along the normal, away from the second; m/s.
  btScalar speed() const;
};

/// f(touches) for each two bodies.
template <class F>
void forEachManifold(btDispatcher& dispatcher, const F& f) {
  std::vector<Touch> touches;
  for (int m = 0; m < dispatcher.getNumManifolds(); ++m) {
    btPersistentManifold& manifold = *dispatcher.getManifoldByIndexInternal(m);
    touches.clear();
    for (int k = 0; k < manifold.getNumContacts(); ++k)
      touches.push_back({manifold.getContactPoint(k), *btRigidBody::upcast(manifold.getBody0()),
                         *btRigidBody::upcast(manifold.getBody1())});
    f(std::as_const(touches));
  }
}
template <class F>
void forEachTouch(btDispatcher& dispatcher, const F& f) {
  forEachManifold(dispatcher, [&](const std::vector<Touch>& touches) {
    for (const Touch& touch : touches) f(touch);
  });
}

/// Gives contacts their friction and restitution, in a part of a step of `dt` s. Speeds below `slow` m/s do
/// not bounce, nor does what meets `walls`, which stay, later than at once.
void setMaterials(btDispatcher& dispatcher, const std::vector<HeldBody>& held, const btRigidBody& walls,
                  double dt, double slow);

}  // namespace weir
