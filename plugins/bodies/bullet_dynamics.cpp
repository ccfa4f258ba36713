#include "plugins/bodies/bullet_dynamics.h"

#include <algorithm>
#include <numeric>
#include <optional>
#include <utility>

#include "plugins/bodies/body_groups.h"
#include "plugins/bodies/bullet_world.h"
#include "plugins/bodies/group_step.h"

namespace weir {

namespace {

std::vector<std::size_t> numbersTo(std::size_t count) {
  std::vector<std::size_t> numbers(count);
  std::iota(numbers.begin(), numbers.end(), std::size_t{0});
  return numbers;
}

/// Where all would be if nothing held them.
SceneBounds sceneBoundsOf(const StepTask& task) {
  SceneBounds bounds;
  for (std::size_t k = 0; k < task.motions.size(); ++k) {
    const BulletBody& body = task.scene.bodies[k];
    bounds.bodies.push_back(boundsOf(*body.shape(), body.transformOf(task.motions[k].before)));
    bounds.bodies.back().extend(boundsOf(*body.shape(), body.transformOf(task.motions[k].after)));
  }
  for (std::size_t k = 0; k < task.solidMotions.size(); ++k) {
    const btCollisionShape& shape = *task.scene.solids[k].shape;
    bounds.solids.push_back(boundsOf(shape, toBullet(task.solidMotions[k].begin)));
    bounds.solids.back().extend(boundsOf(shape, toBullet(task.solidMotions[k].end)));
  }
  return bounds;
}

/// The groups of a step, and those of their ends that are known.
struct Groups {
  std::vector<BodyGroup> groups;
  std::vector<std::optional<GroupResult>> ends;

  /// Takes over the ends of groups that have not changed.
  void regroup(std::vector<BodyGroup> into) {
    std::vector<std::optional<GroupResult>> known(into.size());
    for (std::size_t n = 0, old = 0; n < into.size(); ++n) {
      while (old < groups.size() && groups[old].bodies.front() < into[n].bodies.front()) ++old;
      if (old < groups.size() && groups[old] == into[n]) known[n] = std::move(ends[old]);
    }
    groups = std::move(into);
    ends = std::move(known);
  }

  /// The largest first, as they take longest.
  std::vector<std::size_t> unknown() const {
    std::vector<std::size_t> found;
    for (std::size_t n = 0; n < groups.size(); ++n)
      if (!ends[n]) found.push_back(n);
    std::stable_sort(found.begin(), found.end(), [&](std::size_t a, std::size_t b) {
      return groups[a].bodies.size() > groups[b].bodies.size();
    });
    return found;
  }

  void step(const StepTask& task, CpuThreads& threads) {
    const std::vector<std::size_t> wanted = unknown();
    const auto one = [&](std::int64_t k) {
      const std::size_t n = wanted[std::size_t(k)];
      ends[n] = stepGroup(task, groups[n]);
    };
    threads.run(
        std::int64_t(wanted.size()),
        [](void* context, std::int64_t k) { (*static_cast<const decltype(one)*>(context))(k); },
        const_cast<void*>(static_cast<const void*>(&one)));
  }

  /// Makes bounds as large as bodies needed. Returns whether one was too small.
  bool grow(SceneBounds& bounds) const {
    bool grown = false;
    for (std::size_t n = 0; n < groups.size(); ++n)
      for (std::size_t i = 0; i < groups[n].bodies.size(); ++i) {
        Bounds& box = bounds.bodies[groups[n].bodies[i]];
        grown = grown || !box.contains(ends[n]->bounds[i]);
        box.extend(ends[n]->bounds[i]);
      }
    return grown;
  }

  std::vector<KnownContact> contacts() const {
    std::vector<KnownContact> all;
    for (const auto& end : ends) all.insert(all.end(), end->contacts.begin(), end->contacts.end());
    sortByBodies(all);
    return all;
  }
};

class BulletDynamics final : public BodyDynamics {
 public:
  Overlap set(std::vector<HeldBody> bodies, std::vector<HeldSolid> solids,
              std::vector<HeldJoint> joints) override {
    scene_ = {.held = std::move(bodies), .bodies = {}, .solids = {}, .joints = std::move(joints)};
    for (const HeldBody& body : scene_.held) scene_.bodies.emplace_back(body);
    std::vector<SolidMotion> solidMotions;
    for (const HeldSolid& solid : solids) {
      scene_.solids.push_back(shapeOfSolid(*solid.mesh));
      solidMotions.push_back({solid.start, solid.start});
    }
    return overlap(solidMotions);
  }

  void step(std::vector<Motion>& motions, const std::vector<SolidMotion>& solidMotions,
            const std::vector<JointDrive>& drives, double dt, double slow,
            std::vector<KnownContact>& contacts, CpuThreads& threads) override {
    const StepTask task{scene_, motions, solidMotions, drives, contacts, dt, slow};
    SceneBounds bounds = sceneBoundsOf(task);
    Groups groups;
    do {
      groups.regroup(groupsOf(scene_, bounds));
      groups.step(task, threads);
    } while (groups.grow(bounds));
    for (std::size_t n = 0; n < groups.groups.size(); ++n)
      for (std::size_t i = 0; i < groups.groups[n].bodies.size(); ++i)
        motions[groups.groups[n].bodies[i]] = groups.ends[n]->motions[i];
    contacts = groups.contacts();
  }

 private:
  /// The deepest at the start.
  Overlap overlap(const std::vector<SolidMotion>& solidMotions) const {
    const BodyGroup all{numbersTo(scene_.bodies.size()), numbersTo(scene_.solids.size()),
                        numbersTo(scene_.joints.size())};
    BulletWorld world(scene_, all);
    for (std::size_t k = 0; k < scene_.held.size(); ++k) world.place(k, scene_.held[k].start);
    world.moveSolids(solidMotions, 0, 1);
    return world.deepestOverlap();
  }

  BulletScene scene_;
};

}  // namespace

std::unique_ptr<BodyDynamics> makeBulletDynamics() {
  return std::make_unique<BulletDynamics>();
}

}  // namespace weir
