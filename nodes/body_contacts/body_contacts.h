// Lets bodies collide with each other, with walls and with meshes, and holds them by joints.
//
// Bodies move on by themselves, as forces lead them; then this node takes them all, and a library (a service,
// body_dynamics.h) changes the motion of those that touch something. It does so on the host, on all its
// threads: with CUDA a step waits for the device. Where several ranks share a run, the first one does so for
// all.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "framework/base/api.h"
#include "framework/communication/on_ranks.h"
#include "framework/compute/cpu_threads.h"
#include "framework/graph/node.h"
#include "framework/graph/registry.h"
#include "nodes/body_contacts/body_batch.h"
#include "nodes/body_contacts/body_dynamics.h"
#include "nodes/body_contacts/joint.h"
#include "nodes/rigid_body/rigid_body.h"

namespace WEIR_API weir {

class BodyContacts final : public Node, public OnRanks {
 public:
  static constexpr NodeInfo kInfo{
      "BodyContacts", "Bodies collide and slide, with each other and with solids, and are held by joints.",
      "collision, collide, contact, friction, stack, pile, restitution, bounce, constraint"};
  const NodeInfo& info() const override { return kInfo; }

  Inputs<BodyLink> bodies{*this, "bodies", "The bodies; they keep out of their walls as well.", true};
  Inputs<TriangleMesh> solids{*this, "solids",
                              "Meshes that bodies do not enter: at rest, or moved by a SemiAnalyticalSFI."};
  Inputs<JointLink> joints{*this, "joints", "What holds them."};

  void configure(const SetupContext& context) override;
  void reset(const SetupContext& context) override;
  void step(const StepContext& context) override;
  void report(NodeReport& report) override;
  void join(Communicator& ranks) override { ranks_ = &ranks; }

 private:
  /// Whether the library is this rank's to ask.
  bool asks() const { return ranks_ == nullptr || ranks_->rank() == 0; }
  /// Gives the library what it holds. Throws a scene Error if bodies start within each other or within
  /// solids.
  void setDynamics(const SetupContext& context);
  /// Lets the library change the motions of a step.
  void changeMotions(const StepContext& context, std::vector<BodyDynamics::Motion>& motions);
  /// All ranks get those of the first one.
  template <class T>
  void share(std::vector<T>& values) const;
  int numberOf(const RigidBody& body, const Node& joint) const;
  HeldBody heldBody(const SetupContext& context, std::size_t k) const;
  HeldJoint heldJoint(std::size_t k) const;
  /// What moves a solid; null if it is at rest.
  const RigidMotion* motionOfSolid(std::size_t k) const;
  Pose poseOfSolid(std::size_t k, double time) const;
  std::unique_ptr<BodyDynamics> makeDynamics(const SetupContext& context);
  /// Throws a scene Error if bodies start within each other or within solids.
  void checkOverlap(const BodyDynamics::Overlap& overlap) const;

  Communicator* ranks_ = nullptr;
  std::unique_ptr<BodyDynamics> dynamics_;  // of the rank that asks it
  std::optional<CpuThreads> threads_;       // its own
  std::optional<BodyBatch> batch_;
  std::string source_;
  State<std::vector<KnownContact>> known_{*this, "known"};  // of the last step
  std::int64_t held_ = 0;                                   // bodies, in the last step
};

}  // namespace weir
