#include "plugins/bodies/group_step.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "plugins/bodies/bullet_world.h"

namespace weir {

namespace {

/// How far the corner of its box that goes most goes, m.
double largestDistance(const SolidMotion& motion, const BulletShape& of) {
  btVector3 lo, hi;
  of.shape->getAabb(btTransform::getIdentity(), lo, hi);
  double largest = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3f p{float(corner & 1 ? hi.x() : lo.x()), float(corner & 2 ? hi.y() : lo.y()),
                  float(corner & 4 ? hi.z() : lo.z())};
    largest = std::max(largest, double(length(motion.end.toWorld(p) - motion.begin.toWorld(p))));
  }
  return largest;
}

/// Into which a step is cut, so that nothing goes farther in one than a share of a body's size.
int partsOf(const StepTask& task, const BodyGroup& group) {
  constexpr double kMaxShare = 0.1;
  constexpr int kMin = 2, kMax = 32;
  double largest = 0, fastest = 0, thinnest = std::numeric_limits<double>::infinity();
  for (const std::size_t k : group.bodies) {
    const double thickness = task.scene.bodies[k].thickness();
    largest = std::max(largest, length(task.motions[k].after.velocity) * task.dt / thickness);
    thinnest = std::min(thinnest, thickness);
  }
  for (const std::size_t k : group.solids)
    fastest = std::max(fastest, largestDistance(task.solidMotions[k], task.scene.solids[k]));
  largest = std::max(largest, fastest / thinnest);
  return std::clamp(int(std::ceil(std::min(largest / kMaxShare, double(kMax)))), kMin, kMax);
}

/// Bodies where they were, with the velocities that forces have given them.
void begin(BulletWorld& world, const StepTask& task, const BodyGroup& group) {
  world.doNotBounceBelow(task.slow);
  for (std::size_t i = 0; i < group.bodies.size(); ++i) {
    const auto& [before, after, held] = task.motions[group.bodies[i]];
    world.place(i, {.center = before.center,
                    .rotation = before.rotation,
                    .velocity = after.velocity,
                    .spin = after.spin});
  }
}

}  // namespace

GroupResult stepGroup(const StepTask& task, const BodyGroup& group) {
  BulletWorld world(task.scene, group);
  const std::vector<KnownContact> none;
  begin(world, task, group);
  GroupResult end;
  for (std::size_t i = 0; i < group.bodies.size(); ++i) end.bounds.push_back(world.boundsOf(i));
  const int parts = partsOf(task, group);
  for (int part = 0; part < parts; ++part) {
    world.moveSolids(task.solidMotions, double(part) / parts, task.dt);
    // What forces have done is all in the velocities of the first part, so later parts are unlike it.
    std::vector<KnownContact> found = world.step(task.drives, task.dt / parts, part == 0 ? task.known : none);
    if (part == 0) end.contacts = std::move(found);
    for (std::size_t i = 0; i < group.bodies.size(); ++i) end.bounds[i].extend(world.boundsOf(i));
  }
  for (std::size_t i = 0; i < group.bodies.size(); ++i) {
    end.motions.push_back(task.motions[group.bodies[i]]);
    end.motions.back().held = world.isHeld(i);
    if (world.isHeld(i)) end.motions.back().after = world.stateOf(i);
  }
  return end;
}

}  // namespace weir
