// What the tests of bodies add to the nodes of the project.
#pragma once

#include "framework/graph/registry.h"
#include "plugins/bodies/bullet_dynamics.h"

namespace weir::test {

inline void addBullet(Registry& registry) {
  registry.addService<BodyDynamics>("bullet", [] { return makeBulletDynamics(); });
}

}  // namespace weir::test
