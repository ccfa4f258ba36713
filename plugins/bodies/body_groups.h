// Bodies that may touch each other in a step, apart from all others.
#pragma once

#include <vector>

#include "plugins/bodies/bullet_scene.h"

namespace weir {

/// m.
struct Room {
  btVector3 lo, hi;

  void extend(const Room& b) { lo.setMin(b.lo), hi.setMax(b.hi); }
  Room grownBy(double skin) const {
    const btVector3 by(skin, skin, skin);
    return {lo - by, hi + by};
  }
  bool meets(const Room& b) const;
  bool holds(const Room& b) const;
};

/// Of what has that shape there.
Room roomOf(const btCollisionShape& shape, const btTransform& at);

/// Where bodies and solids are during a step.
struct Rooms {
  std::vector<Room> bodies, solids;
};

/// Bodies whose rooms meet, with less than a skin between them, or that a joint holds together, are of one
/// group. In the order of their first bodies. Without those that have nothing to touch and no joint.
std::vector<BodyGroup> groupsOf(const BulletScene& scene, const Rooms& rooms);

}  // namespace weir
