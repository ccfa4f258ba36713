#include "apps/studio/session/body_pull.h"

#include <algorithm>
#include <utility>

#include "framework/base/error.h"
#include "framework/base/text.h"
#include "nodes/rigid_body/rigid_body.h"

namespace weir::studio {

namespace {

constexpr double kMaxRate = 30;           // 1/s
constexpr double kMaxRateTimesDt = 0.5;   // above 0.83 the body would fly to and fro ever farther
constexpr double kMaxAcceleration = 100;  // m/s²

RigidBody* bodyOf(const Scene& scene, const std::string& node) {
  return dynamic_cast<RigidBody*>(scene.graph.find(node));
}

}  // namespace

void requirePullable(const Scene& scene, const std::string& node) {
  const RigidBody* body = bodyOf(scene, node);
  if (body == nullptr) throw usageError(inQuotes(node) + " is not a body that can be pulled", "a RigidBody");
  if (!body->appliedForce.value().isArray())
    throw usageError(
        "the applied_force of " + inQuotes(node) + " is given by keyframes, so it cannot be pulled",
        "a body whose applied_force is one value");
}

void BodyPull::pull(Simulation& simulation, BodyWish wish) {
  if (wish_ && wish_->node != wish.node) release(simulation);
  RigidBody* body = bodyOf(simulation.scene(), wish.node);
  if (body == nullptr) return;
  if (!wish_) ofScene_ = body->appliedForce;
  wish_ = std::move(wish);
  update(simulation);
}

void BodyPull::update(Simulation& simulation) {
  if (!wish_) return;
  RigidBody& body = *bodyOf(simulation.scene(), wish_->node);
  const BodyState now = body.state();
  const double rate = std::min(kMaxRate, kMaxRateTimesDt / simulation.clock().longestStep());
  Vec3d acceleration = rate * rate * (doubleOf(wish_->to) - now.center) - 2 * rate * now.velocity;
  if (const double size = length(acceleration); size > kMaxAcceleration)
    acceleration = (kMaxAcceleration / size) * acceleration;
  body.appliedForce.set(ofScene_ + floatOf(body.massOf().mass * acceleration));
}

void BodyPull::release(Simulation& simulation) {
  if (!wish_) return;
  bodyOf(simulation.scene(), wish_->node)->appliedForce.set(ofScene_);
  wish_.reset();
}

}  // namespace weir::studio
