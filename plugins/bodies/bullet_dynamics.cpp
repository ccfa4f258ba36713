#include "plugins/bodies/bullet_dynamics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "plugins/bodies/bullet_body.h"
#include "plugins/bodies/bullet_world.h"

namespace weir {

namespace {

/// How far the corner of its box that goes farthest goes, m.
double farthestWay(const SolidWay& way, const BulletShape& of) {
  btVector3 lo, hi;
  of.shape->getAabb(btTransform::getIdentity(), lo, hi);
  double farthest = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3f p{float(corner & 1 ? hi.x() : lo.x()), float(corner & 2 ? hi.y() : lo.y()),
                  float(corner & 4 ? hi.z() : lo.z())};
    farthest = std::max(farthest, double(length(way.end.toWorld(p) - way.begin.toWorld(p))));
  }
  return farthest;
}

class BulletDynamics final : public BodyDynamics {
 public:
  Overlap set(std::vector<HeldBody> bodies, std::vector<HeldSolid> solids,
              std::vector<HeldJoint> joints) override {
    held_ = std::move(bodies);
    joints_ = std::move(joints);
    bodies_.clear();
    solids_.clear();
    for (const HeldBody& body : held_) bodies_.emplace_back(body);
    std::vector<SolidWay> ways;
    for (const HeldSolid& solid : solids) {
      solids_.push_back(shapeOfSolid(*solid.mesh));
      ways.push_back({solid.start, solid.start});
    }
    BulletWorld world(held_, bodies_, solids_, joints_);
    for (std::size_t k = 0; k < bodies_.size(); ++k) world.place(k, held_[k].start);
    world.moveSolids(ways, 0, 1);
    return world.deepestOverlap();
  }

  void step(std::vector<Motion>& motions, const std::vector<SolidWay>& ways,
            const std::vector<JointDrive>& drives, double dt, double slow) override {
    BulletWorld world(held_, bodies_, solids_, joints_);
    world.doNotBounceBelow(slow);
    for (std::size_t k = 0; k < motions.size(); ++k)
      world.place(k, {.center = motions[k].before.center,
                      .rotation = motions[k].before.rotation,
                      .velocity = motions[k].after.velocity,
                      .spin = motions[k].after.spin});
    const int parts = partsOf(motions, ways, dt);
    for (int part = 0; part < parts; ++part) {
      world.moveSolids(ways, double(part) / parts, dt);
      world.step(drives, dt / parts);
    }
    for (std::size_t k = 0; k < motions.size(); ++k) {
      motions[k].held = world.isHeld(k);
      if (motions[k].held) motions[k].after = world.stateOf(k);
    }
  }

 private:
  int partsOf(const std::vector<Motion>& motions, const std::vector<SolidWay>& ways, double dt) const {
    constexpr double kFarthest = 0.1;  // of the size
    constexpr int kMin = 2, kMax = 32;
    double most = 0, fastest = 0, thinnest = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < motions.size(); ++k) {
      most = std::max(most, length(motions[k].after.velocity) * dt / bodies_[k].thickness());
      thinnest = std::min(thinnest, bodies_[k].thickness());
    }
    for (std::size_t k = 0; k < ways.size(); ++k)
      fastest = std::max(fastest, farthestWay(ways[k], solids_[k]));
    most = std::max(most, fastest / thinnest);
    return std::clamp(int(std::ceil(std::min(most / kFarthest, double(kMax)))), kMin, kMax);
  }

  std::vector<HeldBody> held_;
  std::vector<HeldJoint> joints_;
  std::vector<BulletBody> bodies_;
  std::vector<BulletShape> solids_;
};

}  // namespace

std::unique_ptr<BodyDynamics> makeBulletDynamics() {
  return std::make_unique<BulletDynamics>();
}

}  // namespace weir
