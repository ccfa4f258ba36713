// What contacts did in the last step, from which the next one starts: loads that stay need hardly an
// iteration.
#pragma once

#include <btBulletDynamicsCommon.h>

#include <utility>
#include <vector>

#include "nodes/body_contacts/body_dynamics.h"

namespace weir {

/// The number of a body in the scene; less than zero for what is none, the same in each step.
inline int numberOf(const btCollisionObject& object) {
  return object.getUserIndex();
}

/// Ascending by their two bodies, then as they were found.
void sortByBodies(std::vector<KnownContact>& contacts);

/// Assigns the impulse of each known contact to that of Bullet's points of the same two bodies which is
/// nearest to where it was, seen from the first of them, and faces the same way. Points of a face come and go
/// as bodies turn by a millionth, but what two bodies bear stays. Known contacts are sorted. Returns the
/// sums, to which points point as long as this lives.
std::vector<Vec3d> assignImpulses(btDispatcher& dispatcher, const std::vector<KnownContact>& known);
/// On the first body, N·s; null if there is none.
const Vec3d* assignedImpulse(const btManifoldPoint& point);
/// Those that did something.
std::vector<KnownContact> contactsOf(btDispatcher& dispatcher);

}  // namespace weir
