// Contacts of bodies with walls by signed distance, which Bullet does not know: vertices of a body within
// reach of a wall, four to a manifold.
#pragma once

#include <btBulletDynamicsCommon.h>

#include <vector>

#include "plugins/bodies/bullet_scene.h"

namespace weir {

class WallContacts {
 public:
  /// `walls` stands for all walls.
  WallContacts(btCollisionDispatcher& dispatcher, btRigidBody& walls)
      : dispatcher_(dispatcher), walls_(walls) {}
  ~WallContacts() { forget(); }
  WallContacts(const WallContacts&) = delete;
  WallContacts& operator=(const WallContacts&) = delete;

  /// Those that a body may have in a part of a step of `dt` s.
  void add(btRigidBody& body, const BulletBody& as, const HeldBody& held, double dt);
  void forget();

  /// m: how far off walls contacts are known of what does not move.
  static double reachOf(const BulletBody& body);

 private:
  btCollisionDispatcher& dispatcher_;
  btRigidBody& walls_;
  std::vector<btPersistentManifold*> manifolds_;
};

}  // namespace weir
