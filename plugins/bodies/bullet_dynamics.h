// Contacts and joints by Bullet.
//
// Bullet's world is made anew in each step, so that a step depends on the bodies' motions alone: it keeps no
// contacts, and a resumed run goes on bit by bit. A step is cut into parts in which no body goes farther than
// a share of its size. Bullet's own numbers that are lengths follow the size of the bodies.
#pragma once

#include <memory>

#include "nodes/body_contacts/body_dynamics.h"

namespace weir {

std::unique_ptr<BodyDynamics> makeBulletDynamics();

}  // namespace weir
