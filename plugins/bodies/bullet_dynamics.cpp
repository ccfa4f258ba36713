#include "plugins/bodies/bullet_dynamics.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "plugins/bodies/bullet_body.h"
#include "plugins/bodies/bullet_world.h"

namespace weir {

namespace {

class BulletDynamics final : public BodyDynamics {
 public:
  Overlap set(std::vector<HeldBody> bodies, const std::vector<const TriangleMesh*>& solids,
              std::vector<HeldJoint> joints) override {
    held_ = std::move(bodies);
    joints_ = std::move(joints);
    bodies_.clear();
    solids_.clear();
    for (const HeldBody& body : held_) bodies_.emplace_back(body);
    for (const TriangleMesh* solid : solids) solids_.push_back(shapeOfSolid(*solid));
    BulletWorld world(held_, bodies_, solids_, joints_);
    for (std::size_t k = 0; k < bodies_.size(); ++k) world.place(k, held_[k].start, Twist{});
    return world.deepestOverlap();
  }

  void step(std::vector<Motion>& motions, const std::vector<JointDrive>& drives, double dt,
            double slow) override {
    BulletWorld world(held_, bodies_, solids_, joints_);
    world.doNotBounceBelow(slow);
    for (std::size_t k = 0; k < motions.size(); ++k)
      world.place(k, motions[k].before,
                  twistOf(held_[k].mass, {.rotation = motions[k].before.rotation,
                                          .velocity = motions[k].after.velocity,
                                          .spin = motions[k].after.spin}));
    const int parts = partsOf(motions, dt);
    for (int part = 0; part < parts; ++part) world.step(drives, dt / parts);
    for (std::size_t k = 0; k < motions.size(); ++k) {
      motions[k].held = world.isHeld(k);
      if (motions[k].held) motions[k].after = world.stateOf(k);
    }
  }

 private:
  int partsOf(const std::vector<Motion>& motions, double dt) const {
    constexpr double kFarthest = 0.1;  // of the size
    constexpr int kMin = 2, kMax = 32;
    double most = 0;
    for (std::size_t k = 0; k < motions.size(); ++k)
      most = std::max(most, length(motions[k].after.velocity) * dt / bodies_[k].thickness());
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
