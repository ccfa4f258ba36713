// Bodies that may touch each other in a step, apart from all others.
#pragma once

#include <vector>

#include "plugins/bodies/bullet_scene.h"

namespace weir {

/// m.
struct Bounds {
  btVector3 lo, hi;

  void extend(const Bounds& b) { lo.setMin(b.lo), hi.setMax(b.hi); }
  Bounds expandedBy(double skin) const {
    const btVector3 by(skin, skin, skin);
    return {lo - by, hi + by};
  }
  bool overlaps(const Bounds& b) const;
  bool contains(const Bounds& b) const;
};

/// Of what has that shape there.
Bounds boundsOf(const btCollisionShape& shape, const btTransform& at);

/// Where bodies and solids are during a step.
struct SceneBounds {
  std::vector<Bounds> bodies, solids;
};

/// Bodies whose bounds overlap, with less than a skin between them, or that a joint holds together, are of
/// one group. In the order of their first bodies. Without those that have nothing to touch and no joint.
std::vector<BodyGroup> groupsOf(const BulletScene& scene, const SceneBounds& bounds);

}  // namespace weir
