// Contacts and joints by Bullet.
//
// Bodies that may touch each other in a step are a group (body_groups.h), which has a world of its own and a
// thread to itself. Should one go farther than it seemed to, as others push it, and so come near another
// group, both are taken once more as one. Worlds are made anew in each step, so that a step depends on the
// bodies' motions, and on what contacts did in the last one, alone: a resumed run goes on bit by bit. A step
// is cut into parts in which no body of the group goes farther than a share of its size. Bullet's own numbers
// that are lengths follow the size of the bodies.
#pragma once

#include <memory>

#include "nodes/body_contacts/body_dynamics.h"

namespace weir {

std::unique_ptr<BodyDynamics> makeBulletDynamics();

}  // namespace weir
