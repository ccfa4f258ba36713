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

/// Rooms with what contacts may be apart.
std::vector<Room> reachesOf(const BulletScene& scene, const Rooms& rooms) {
  std::vector<Room> reaches;
  for (std::size_t k = 0; k < rooms.bodies.size(); ++k)
    reaches.push_back(rooms.bodies[k].grownBy(scene.bodies[k].apart()));
  return reaches;
}

/// The axis along which they are spread most.
int longestAxis(const std::vector<Room>& rooms) {
  if (rooms.empty()) return 0;
  Room all = rooms.front();
  for (const Room& room : rooms) all.extend(room);
  return (all.hi - all.lo).maxAxis();
}

/// f(a, b) for each two that meet: sweeps along an axis, as in Baraff 1992.
template <class F>
void forEachMeeting(const std::vector<Room>& rooms, const F& f) {
  const int axis = longestAxis(rooms);
  std::vector<std::size_t> order(rooms.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return rooms[a].lo[axis] < rooms[b].lo[axis]; });
  for (std::size_t i = 0; i < order.size(); ++i)
    for (std::size_t j = i + 1; j < order.size(); ++j) {
      const Room &one = rooms[order[i]], &two = rooms[order[j]];
      if (two.lo[axis] > one.hi[axis]) break;
      if (one.meets(two)) f(order[i], order[j]);
    }
}

/// Whether a wall by signed distance may be within the ball around the room.
bool hasWall(const HeldBody& held, const Room& room) {
  const btVector3 center = 0.5 * (room.lo + room.hi);
  const double radius = 0.5 * (room.hi - room.lo).length();
  bool has = false;
  for (const BoundaryPiece& piece : held.walls)
    forEachWall(piece, floatOf(fromBullet(center)),
                [&](float distance, const Vec3f&) { has = has || double(distance) < radius; });
  return has;
}

/// Solids that its bodies may touch.
std::vector<std::size_t> solidsOf(const BodyGroup& group, const std::vector<Room>& reaches,
                                  const std::vector<Room>& solids) {
  std::vector<std::size_t> near;
  for (std::size_t k = 0; k < solids.size(); ++k)
    if (std::any_of(group.bodies.begin(), group.bodies.end(),
                    [&](std::size_t body) { return reaches[body].meets(solids[k]); }))
      near.push_back(k);
  return near;
}

DisjointSets setsOf(const BulletScene& scene, const std::vector<Room>& reaches) {
  DisjointSets sets(reaches.size());
  forEachMeeting(reaches, [&](std::size_t a, std::size_t b) { sets.unite(a, b); });
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

bool Room::meets(const Room& b) const {
  for (int k = 0; k < 3; ++k)
    if (lo[k] > b.hi[k] || b.lo[k] > hi[k]) return false;
  return true;
}

bool Room::holds(const Room& b) const {
  for (int k = 0; k < 3; ++k)
    if (b.lo[k] < lo[k] || b.hi[k] > hi[k]) return false;
  return true;
}

Room roomOf(const btCollisionShape& shape, const btTransform& at) {
  Room room;
  shape.getAabb(at, room.lo, room.hi);
  return room;
}

std::vector<BodyGroup> groupsOf(const BulletScene& scene, const Rooms& rooms) {
  const std::vector<Room> reaches = reachesOf(scene, rooms);
  std::vector<BodyGroup> groups = membersOf(setsOf(scene, reaches), scene);
  for (BodyGroup& group : groups) group.solids = solidsOf(group, reaches, rooms.solids);
  std::erase_if(groups, [&](const BodyGroup& group) {
    if (group.bodies.size() != 1) return group.bodies.empty();
    const std::size_t alone = group.bodies.front();
    return group.joints.empty() && group.solids.empty() && !hasWall(scene.held[alone], reaches[alone]);
  });
  return groups;
}

}  // namespace weir
