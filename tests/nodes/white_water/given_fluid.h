// Particles that do what a test says, and the white water that they make.
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "nodes/white_water/white_water.h"
#include "tests/support/fluid_scene.h"

namespace weir::test {

/// Particles that do what a test says.
class GivenFluid final : public Node {
 public:
  static constexpr NodeInfo kInfo{"GivenFluid", "Particles of a test."};
  const NodeInfo& info() const override { return kInfo; }

  Output<Particles> fluid{*this, "fluid", "The particles."};
  std::vector<Vec3f> positions, velocities;
  float spacing = 0.02f;
  std::function<void(GivenFluid&, const StepContext&)> onStep;

  void reset(const SetupContext& context) override {
    set_.emplace(context.device);
    ParticleBatch batch;
    batch.assign(context.device, positions, velocities);
    set_->append(batch);
    fluid->material = {
        .spacing = spacing, .density = {.value = 1000}, .volume = {.value = spacing * spacing * spacing}};
    fluid->assign(*set_);
  }
  void step(const StepContext& context) override {
    if (onStep) onStep(*this, context);
  }
  ParticleSet& set() { return *set_; }

 private:
  std::optional<ParticleSet> set_;
};

struct WhiteParticle {
  Vec3f position, velocity;
  int kind = 0;
  float age = 0, lifetime = 0, radius = 0;
};

class Given {
 public:
  explicit Given(Device& device) : device_(device) {
    fluid = static_cast<GivenFluid*>(&graph_.add(std::make_unique<GivenFluid>(), "water"));
    foam = static_cast<WhiteWater*>(&graph_.add(std::make_unique<WhiteWater>(), "foam"));
    graph_.link(SceneGraph::parseLink("water.fluid -> foam.fluid"));
  }
  void assign(const Value& parameters) { foam->assignAll(parameters, {"test", "", ""}); }
  void reset(double dt) {
    dt_ = dt, steps_ = 0;
    graph_.reset({device_, log_, registry_, gravity, dt, 1});
  }
  /// In steps of the dt, with a frame after every `inFrame` of them.
  void step(int steps, int inFrame = 10) {
    for (int k = 0; k < steps; ++k) {
      graph_.step({device_, log_, gravity, double(steps_) * dt_, dt_, steps_});
      ++steps_;
      if (steps_ % inFrame == 0) graph_.frame({device_, log_, gravity, double(steps_) * dt_, dt_, steps_});
    }
  }
  Value report() {
    NodeReport report;
    foam->report(report);
    return report.statistics;
  }
  /// By id.
  std::map<std::int64_t, WhiteParticle> particles() {
    ParticleSet& set = foam->particles->set();
    const std::int64_t n = set.refreshCount();
    const auto ids = set.ids().toHost(n);
    const auto x = set.positions().toHost(n), v = set.velocities().toHost(n);
    const auto kinds = set.get<int>("type").toHost(n);
    const auto ages = set.get<float>("age").toHost(n), lifetimes = set.get<float>("lifetime").toHost(n),
               radii = set.get<float>("radius").toHost(n);
    std::map<std::int64_t, WhiteParticle> all;
    for (std::size_t k = 0; k < ids.size(); ++k)
      all[ids[k]] = {x[k], v[k], kinds[k], ages[k], lifetimes[k], radii[k]};
    return all;
  }

  GivenFluid* fluid;
  WhiteWater* foam;
  Vec3f gravity{0, -9.8f, 0};
  std::vector<std::string> warnings;

 private:
  Device& device_;
  Log log_{[this](LogLevel level, std::string_view text) {
    if (level == LogLevel::kWarning) warnings.emplace_back(text);
  }};
  Registry registry_;
  SceneGraph graph_;
  double dt_ = 0;
  std::int64_t steps_ = 0;
};

constexpr int kSpray = 0, kFoam = 1, kBubble = 2;

/// Of neighbouring particles on the lattice, one goes one way and one the other.
inline std::vector<Vec3f> whirl(const std::vector<Vec3f>& positions, float spacing, float speed,
                                const Vec3f& mean) {
  std::vector<Vec3f> velocities;
  for (const Vec3f& p : positions) {
    const long cell = std::lround(p.x / spacing) + std::lround(p.y / spacing) + std::lround(p.z / spacing);
    velocities.push_back(mean + Vec3f{cell % 2 == 0 ? speed : -speed, 0, 0});
  }
  return velocities;
}

}  // namespace weir::test
