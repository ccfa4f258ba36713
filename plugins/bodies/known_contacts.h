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

/// Lets each point of Bullet's contacts that is where a known one was, seen from its first body, point at
/// that one; others at nothing. Known contacts are sorted, and must outlive the points.
void recognise(btDispatcher& dispatcher, const std::vector<KnownContact>& known);
/// That a point was recognised as; null if there is none.
const KnownContact* knownAs(const btManifoldPoint& point);
/// Those that did something.
std::vector<KnownContact> contactsOf(btDispatcher& dispatcher);

}  // namespace weir
