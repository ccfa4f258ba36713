// A fluid in a test: given particles, a ParticleFluid, perhaps walls, on one device.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "framework/graph/registry.h"
#include "framework/graph/scene_graph.h"
#include "nodes/particle_fluid/particle_fluid.h"

namespace weir::test {

/// A node that puts out the particles it is given.
class GivenParticles final : public Node {
 public:
  static constexpr NodeInfo kInfo{"GivenParticles", "Particles of a test."};
  const NodeInfo& info() const override { return kInfo; }

  Output<ParticleBatch> particles{*this, "particles", "The particles."};
  std::vector<Vec3f> positions, velocities;

  void reset(const SetupContext& context) override {
    particles->assign(context.device, positions, velocities);
  }
};

class FluidScene {
 public:
  /// `parameters` are those of the ParticleFluid, with a support of 1.5 spacings if they have none, `modules`
  /// its "modules", both as JSON-like values. The solver is SemiImplicitSolver where they name none.
  FluidScene(Device& device, std::vector<Vec3f> positions, std::vector<Vec3f> velocities,
             const Value& parameters, const Value& modules = Value::object());

  SceneGraph& graph() { return graph_; }
  ParticleFluid& fluid() { return *fluid_; }
  Vec3f gravity{0, -9.8f, 0};
  std::int64_t seed = 1;

  void reset(double dt);
  void step(int steps = 1);
  void frame();

  /// In the order of the ids.
  std::vector<Vec3f> positions() const;
  std::vector<Vec3f> velocities() const;
  NodeReport report();
  const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  StepContext context() const;
  std::vector<Vec3f> byId(const Attribute<const Vec3f>& values) const;

  Device& device_;
  std::vector<std::string> warnings_;
  Log log_{[this](LogLevel level, std::string_view text) {
    if (level == LogLevel::kWarning) warnings_.emplace_back(text);
  }};
  Registry registry_;
  SceneGraph graph_;
  ParticleFluid* fluid_;
  double dt_ = 0;
  std::int64_t steps_ = 0;
};

/// n³ particles on a lattice from `corner`, each moved by up to `jitter` spacings along each axis.
std::vector<Vec3f> jitteredCube(int n, float spacing, float jitter, unsigned seed, Vec3f corner = {});

/// {"a": 1, "b": 2} as a Value.
Value object(std::initializer_list<std::pair<const char*, Value>> members);

}  // namespace weir::test
