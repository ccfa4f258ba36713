#include "plugins/bodies/body_groups.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "nodes/static_boundary/boundary.h"
#include "plugins/bodies/wall_contacts.h"

namespace weir {

namespace {

/// Sets of numbers (union-find); the root of a set is its smallest number.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parents_(count) {
    std::iota(parents_.begin(), parents_.end(), std::size_t{0});
  }
  std::size_t rootOf(std::size_t k) {
    while (parents_[k] != k) k = parents_[k] = parents_[parents_[k]];
    return k;
  }
  void unite(std::size_t a, std::size_t b) {
    a = rootOf(a), b = rootOf(b);
    parents_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::size_t> parents_;
};

/// Bounds, with the distance at which contacts begin.
std::vector<Bounds> reachesOf(const BulletScene& scene, const SceneBounds& bounds) {
  std::vector<Bounds> reaches;
  for (std::size_t k = 0; k < bounds.bodies.size(); ++k)
    reaches.push_back(bounds.bodies[k].expandedBy(scene.bodies[k].apart()));
  return reaches;
}

/// The axis along which they are spread most.
int longestAxis(const std::vector<Bounds>& bounds) {
  if (bounds.empty()) return 0;
  Bounds all = bounds.front();
  for (const Bounds& box : bounds) all.extend(box);
  return (all.hi - all.lo).maxAxis();
}

/// f(a, b) for each two that meet: sweeps along an axis, as in Baraff 1992.
template <class F>
void forEachOverlap(const std::vector<Bounds>& bounds, const F& f) {
  const int axis = longestAxis(bounds);
  std::vector<std::size_t> order(bounds.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return bounds[a].lo[axis] < bounds[b].lo[axis]; });
  for (std::size_t i = 0; i < order.size(); ++i)
    for (std::size_t j = i + 1; j < order.size(); ++j) {
      const Bounds &one = bounds[order[i]], &two = bounds[order[j]];
      if (two.lo[axis] > one.hi[axis]) break;
      if (one.overlaps(two)) f(order[i], order[j]);
    }
}

/// Whether a wall by signed distance may be within the ball around the room.
bool hasWall(const HeldBody& held, const Bounds& box) {
  const btVector3 center = 0.5 * (box.lo + box.hi);
  const double radius = 0.5 * (box.hi - box.lo).length();
  bool has = false;
  for (const BoundaryPiece& piece : held.walls)
    forEachWall(piece, floatOf(fromBullet(center)),
                [&](float distance, const Vec3f&) { has = has || double(distance) < radius; });
  return has;
}

/// Solids that its bodies may touch.
std::vector<std::size_t> solidsOf(const BodyGroup& group, const std::vector<Bounds>& reaches,
                                  const std::vector<Bounds>& solids) {
  std::vector<std::size_t> near;
  for (std::size_t k = 0; k < solids.size(); ++k)
    if (std::any_of(group.bodies.begin(), group.bodies.end(),
                    [&](std::size_t body) { return reaches[body].overlaps(solids[k]); }))
      near.push_back(k);
  return near;
}

DisjointSets setsOf(const BulletScene& scene, const std::vector<Bounds>& reaches) {
  DisjointSets sets(reaches.size());
  forEachOverlap(reaches, [&](std::size_t a, std::size_t b) { sets.unite(a, b); });
  for (const HeldJoint& joint : scene.joints)
    if (joint.b >= 0) sets.unite(std::size_t(joint.a), std::size_t(joint.b));
  return sets;
}

/// All of them, in the places of their first bodies; other places are empty.
std::vector<BodyGroup> membersOf(DisjointSets sets, const BulletScene& scene) {
  std::vector<BodyGroup> groups(scene.bodies.size());
  for (std::size_t k = 0; k < scene.bodies.size(); ++k) groups[sets.rootOf(k)].bodies.push_back(k);
  for (std::size_t k = 0; k < scene.joints.size(); ++k)
    groups[sets.rootOf(std::size_t(scene.joints[k].a))].joints.push_back(k);
  return groups;
}

}  // namespace

bool Bounds::overlaps(const Bounds& b) const {
  for (int k = 0; k < 3; ++k)
    if (lo[k] > b.hi[k] || b.lo[k] > hi[k]) return false;
  return true;
}

bool Bounds::contains(const Bounds& b) const {
  for (int k = 0; k < 3; ++k)
    if (b.lo[k] < lo[k] || b.hi[k] > hi[k]) return false;
  return true;
}

Bounds boundsOf(const btCollisionShape& shape, const btTransform& at) {
  Bounds box;
  shape.getAabb(at, box.lo, box.hi);
  return box;
}

std::vector<BodyGroup> groupsOf(const BulletScene& scene, const SceneBounds& bounds) {
  const std::vector<Bounds> reaches = reachesOf(scene, bounds);
  std::vector<BodyGroup> groups = membersOf(setsOf(scene, reaches), scene);
  for (BodyGroup& group : groups) group.solids = solidsOf(group, reaches, bounds.solids);
  std::erase_if(groups, [&](const BodyGroup& group) {
    if (group.bodies.size() != 1) return group.bodies.empty();
    const std::size_t alone = group.bodies.front();
    return group.joints.empty() && group.solids.empty() && !hasWall(scene.held[alone], reaches[alone]);
  });
  return groups;
}

}  // namespace weir
