// A step of a group of bodies, whatever others do.
#pragma once

#include <vector>

#include "plugins/bodies/body_groups.h"
#include "plugins/bodies/bullet_scene.h"
#include "plugins/bodies/known_contacts.h"

namespace weir {

/// Of all bodies and solids of a scene.
struct StepTask {
  const BulletScene& scene;
  const std::vector<BodyDynamics::Motion>& motions;
  const std::vector<SolidMotion>& solidMotions;
  const std::vector<JointDrive>& drives;
  const std::vector<KnownContact>& known;  ///< sorted, of the last step
  double dt, slow;                         ///< s, m/s
};

/// In the order of the group's bodies.
struct GroupResult {
  std::vector<BodyDynamics::Motion> motions;
  std::vector<Bounds> bounds;  ///< where they have been
  std::vector<KnownContact> contacts;
};

GroupResult stepGroup(const StepTask& task, const BodyGroup& group);

}  // namespace weir
