// Contacts of two convex hulls: whole faces, whether they touch or are still apart. Bullet's own algorithm
// knows the nearest point alone of hulls that are apart, about which a body turns as it meets the other; and
// of those that touch keeps that point beside four of the face, of which it then drops one.
#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionCreateFunc.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>

namespace weir {

class HullContacts final : public btCollisionAlgorithmCreateFunc {
 public:
  /// Takes all pairs of hulls of the dispatcher, which this must outlive.
  explicit HullContacts(btCollisionDispatcher& dispatcher);

  btCollisionAlgorithm* CreateCollisionAlgorithm(btCollisionAlgorithmConstructionInfo& info,
                                                 const btCollisionObjectWrapper* one,
                                                 const btCollisionObjectWrapper* two) override;
};

}  // namespace weir
