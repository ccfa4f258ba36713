#include "nodes/body_contacts/body_contacts.h"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <type_traits>
#include <utility>

#include "framework/base/check.h"
#include "framework/graph/guard.h"

namespace weir {

void BodyContacts::configure(const SetupContext& context) {
  if (context.registry.createServices<BodyDynamics>().empty())
    throw sceneError(
        "no plugin that holds bodies is loaded, so they cannot collide", {},
        "'weir info' lists the plugins; build Weir with Bullet (./dev setup), which brings 'bodies'");
}

std::unique_ptr<BodyDynamics> BodyContacts::makeDynamics(const SetupContext& context) {
  auto services = context.registry.createServices<BodyDynamics>();
  source_ = services.front().source;
  return std::move(services.front().implementation);
}

int BodyContacts::numberOf(const RigidBody& body, const Node& joint) const {
  for (std::size_t k = 0; k < bodies.size(); ++k)
    if (bodies[k].body == &body) return static_cast<int>(k);
  throw sceneError(
      fmt::format("the joint '{}' holds '{}', which is not among the bodies", joint.name(), body.name()),
      fmt::format("the link {}.body -> {}.{}", body.name(), name(), bodies.name()));
}

HeldBody BodyContacts::heldBody(const SetupContext& context, std::size_t k) const {
  const RigidBody& body = *bodies[k].body;
  HeldBody held{.mesh = body.mesh.get(),
                .mass = body.massOf(),
                .start = body.state(),
                .friction = body.wallFriction,
                .restitution = body.restitution,
                .shape = body.contactShape};
  for (std::size_t i = 0; i < body.walls.size(); ++i)
    for (const BoundaryPiece& piece : body.walls[i].pieces) {
      if (piece.isMesh && context.device.kind() != DeviceKind::kCpu)
        throw sceneError(fmt::format("'{}' is held by a mesh of '{}', which the host cannot ask with CUDA",
                                     body.name(), body.walls.links()[i]->node().name()),
                         fmt::format("the mesh linked to {}.{}", name(), solids.name()));
      held.walls.push_back(piece);
    }
  return held;
}

const RigidMotion* BodyContacts::motionOfSolid(std::size_t k) const {
  for (const InputPort* input : solids.links()[k]->links()) {
    const Node* const node = &input->node();
    if (dynamic_cast<const RigidBody*>(node) != nullptr) continue;  // its mesh elsewhere
    if (const auto* motion = dynamic_cast<const RigidMotion*>(node)) return motion;
  }
  return nullptr;
}

Pose BodyContacts::poseOfSolid(std::size_t k, double time) const {
  const RigidMotion* const motion = motionOfSolid(k);
  return motion != nullptr ? motion->poseAt(time) : Pose{};
}

HeldJoint BodyContacts::heldJoint(std::size_t k) const {
  const Joint& joint = *joints[k].joint;
  const int other = joint.other.linked() ? numberOf(*joint.other->body, joint) : -1;
  return joint.between(numberOf(*joint.body->body, joint), other);
}

void BodyContacts::checkOverlap(const BodyDynamics::Overlap& overlap) const {
  if (overlap.a < 0) return;
  const RigidBody& body = *bodies[std::size_t(overlap.a)].body;
  const double most = 0.02 * body.radius();
  if (!(overlap.depth > most)) return;
  const std::string other =
      overlap.b < 0 ? "a solid" : "'" + bodies[std::size_t(overlap.b)].body->name() + "'";
  throw sceneError(fmt::format("'{}' starts {:.3g} m deep within {}", body.name(), overlap.depth, other),
                   fmt::format("bodies that start apart, or at most {:.1g} m within each other", most),
                   "change the position of one of them");
}

void BodyContacts::setDynamics(const SetupContext& context) {
  dynamics_ = makeDynamics(context);
  std::vector<HeldBody> held;
  std::vector<HeldSolid> solid;
  std::vector<HeldJoint> jointed;
  for (std::size_t k = 0; k < bodies.size(); ++k) held.push_back(heldBody(context, k));
  for (std::size_t k = 0; k < solids.size(); ++k)
    solid.push_back({.mesh = &solids[k], .start = poseOfSolid(k, 0)});
  for (std::size_t k = 0; k < joints.size(); ++k) jointed.push_back(heldJoint(k));
  BodyDynamics::Overlap overlap;
  callGuarded(
      source_, [&] { return hookText("", "set", source_); },
      [&] { overlap = dynamics_->set(std::move(held), std::move(solid), std::move(jointed)); });
  checkOverlap(overlap);
}

void BodyContacts::reset(const SetupContext& context) {
  const auto* cpu = dynamic_cast<const CpuBackend*>(&context.device);
  threads_.emplace(cpu != nullptr ? cpu->threads() : 0);
  known_->clear();
  if (asks()) setDynamics(context);
  std::vector<BodyBatch::Member> members;
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    RigidBody& body = *bodies[k].body;
    members.push_back({body.onDevice(), body.leaveMoving(*this)});
  }
  batch_.emplace(context.device, members);
}

void BodyContacts::changeMotions(const StepContext& context, std::vector<BodyDynamics::Motion>& motions) {
  constexpr double kSteps = 2;  // of a fall: what is slower does not bounce
  std::vector<SolidMotion> solidMotions;
  std::vector<JointDrive> drives;
  for (std::size_t k = 0; k < solids.size(); ++k)
    solidMotions.push_back({poseOfSolid(k, context.time), poseOfSolid(k, context.time + context.dt)});
  for (std::size_t k = 0; k < joints.size(); ++k) drives.push_back(joints[k].joint->drive());
  callGuarded(
      source_, [&] { return hookText("", "step", source_); },
      [&] {
        dynamics_->step(motions, solidMotions, drives, context.dt,
                        kSteps * context.dt * length(context.gravity), *known_, *threads_);
      });
}

template <class T>
void BodyContacts::share(std::vector<T>& values) const {
  static_assert(std::is_trivially_copyable_v<T>);
  if (ranks_ == nullptr) return;
  const auto bytes = std::as_bytes(std::span(values));
  if (asks()) {
    for (int to = 1; to < ranks_->size(); ++to) ranks_->post(to, Message(bytes.begin(), bytes.end()));
    return;
  }
  const Message shared = ranks_->receive(0);
  WEIR_CHECK(shared.size() % sizeof(T) == 0u);
  values.resize(shared.size() / sizeof(T));
  std::copy(shared.begin(), shared.end(), std::as_writable_bytes(std::span(values)).begin());
}

void BodyContacts::step(const StepContext& context) {
  std::vector<BodyDynamics::Motion> motions = batch_->moveOn(context.gravity, context.dt);
  if (asks()) changeMotions(context, motions);
  share(motions);
  share(*known_);
  held_ = batch_->place(motions);
  for (std::size_t k = 0; k < bodies.size(); ++k) bodies[k].body->tellState(motions[k].after);
}

void BodyContacts::report(NodeReport& report) {
  report.statistics["held"] = held_;
}

}  // namespace weir
