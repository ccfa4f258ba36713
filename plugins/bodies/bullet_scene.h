// What Bullet holds, and a part of it that meets nothing else.
#pragma once

#include <cstddef>
#include <vector>

#include "nodes/body_contacts/body_dynamics.h"
#include "plugins/bodies/bullet_body.h"

namespace weir {

struct BulletScene {
  std::vector<HeldBody> held;
  std::vector<BulletBody> bodies;  // as they are held
  std::vector<BulletShape> solids;
  std::vector<HeldJoint> joints;
};

/// Their numbers in the scene, ascending.
struct BodyGroup {
  std::vector<std::size_t> bodies, solids, joints;
  friend bool operator==(const BodyGroup&, const BodyGroup&) = default;
};

}  // namespace weir
