// Bodies that fly into water conserve momentum with it.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <cstdio>

#include "nodes/particle_fluid/particle_fluid.h"
#include "nodes/rigid_body/rigid_body.h"
#include "tests/support/devices.h"
#include "tests/support/simulated_scene.h"

namespace weir::test {
namespace {

constexpr const char* kTwoProjections = R"("type": "TwoProjections")";

/// A cube that flies into a block of water, without gravity and walls; or many small ones, from two sides.
struct Impact {
  explicit Impact(const std::string& solver, int count = 1, const std::string& device = "cpu")
      : device_(openDevice(device)), count_(count), scene(*device_, textWith(solver, count)) {
    scene->reset();
  }
  const RigidBody& body(int k = 0) { return scene.node<RigidBody>(fmt::format("body{}", k).c_str()); }
  /// Of the water and the bodies, about the origin.
  SolidImpulse momentum() {
    const ParticleFluid& water = scene.node<ParticleFluid>("water");
    const ParticleSet& particles = (*water.fluid).set();
    const std::vector<Vec3f> positions = particles.positions().toHost(water.particleCount()),
                             velocities = particles.velocities().toHost(water.particleCount());
    SolidImpulse sum;
    for (int k = 0; k < count_; ++k) {
      const BodyState at = body(k).state();
      const double mass = body(k).massOf().mass;
      sum += {mass * at.velocity, mass * cross(at.center, at.velocity) + at.spin};
    }
    for (std::size_t i = 0; i < positions.size(); ++i) {
      const Vec3d p = water.constants().particleMass * doubleOf(velocities[i]);
      sum += {p, cross(doubleOf(positions[i]), p)};
    }
    return sum;
  }
  /// Without that of turning.
  double kineticEnergy() {
    const ParticleFluid& water = scene.node<ParticleFluid>("water");
    const ParticleSet& particles = (*water.fluid).set();
    double sum = 0;
    for (const Vec3f& v : particles.velocities().toHost(water.particleCount()))
      sum += water.constants().particleMass * dot(doubleOf(v), doubleOf(v)) / 2;
    for (int k = 0; k < count_; ++k)
      sum += body(k).massOf().mass * dot(body(k).state().velocity, body(k).state().velocity) / 2;
    return sum;
  }

 private:
  static std::string textWith(const std::string& solver, int count) {
    const double half = count == 1 ? 0.05 : 0.018;
    std::string bodies, links;
    for (int k = 0; k < count; ++k) {
      bodies +=
          fmt::format(R"("body{}": {{"type": "RigidBody", "params": {{"density": 300, {}}}}},)", k,
                      count == 1 ? R"("position": [0.02, 0.16, 0.01], "velocity": [0, -1, 0])" : wayOf(k));
      links += fmt::format(R"(, "water.fluid -> body{0}.fluid", "cube.surface -> body{0}.mesh")", k);
    }
    return fmt::format(
        R"({{"weir": 1,
      "world": {{"gravity": [0, 0, 0], "dt": 0.002, "frame_rate": 50, "duration": 1}},
      "nodes": {{
        "block": {{"type": "BoxSampler", "params": {{"min": [-0.1, -0.1, -0.1], "max": [0.1, 0.1, 0.1]}}}},
        "cube": {{"type": "BoxMesh", "params": {{"min": [-{0}, -{0}, -{0}], "max": [{0}, {0}, {0}]}}}},
        {1}
        "water": {{"type": "ParticleFluid", "params": {{"spacing": 0.02, "rest_steps": 0}},
                  "modules": {{"solver": {{{2}}}, "viscosity": {{"enabled": false}}}}}}}},
      "links": ["block.particles -> water.initial"{3}]}})",
        half, bodies, solver, links);
  }
  static std::string wayOf(int k) {
    const double side = k % 2 == 0 ? 1 : -1;
    return fmt::format(R"("position": [{}, {}, {}], "velocity": [0, {}, 0])", -0.06 + 0.06 * (k / 2 % 3),
                       side * 0.128, -0.06 + 0.06 * (k / 6), -side);
  }
  std::unique_ptr<Device> device_;
  int count_;

 public:
  SimulatedScene scene;
};

/// Positions that are corrected without velocities turn a little more.
double mostTurned(const std::string& solver) {
  return solver == kTwoProjections ? 3e-3 : 1e-3;
}

/// What the water loses the body gets. The solver must have converged, since particles lose momentum to each
/// other where it has not. Steps that end where particles have gone, and not where they pushed, leave of the
/// angular momentum what the velocities between them do in a step.
TEST(Floats, MomentumIsConservedWithoutGravity) {
  for (
      const char* solver :
      {R"("params": {"iterations": 800})",
       R"("type": "AcceleratedSolver", "params": {"tolerance": null, "max_iterations": 400, "neighbor_searches": 2})",
       kTwoProjections}) {
    Impact impact(solver);
    const SolidImpulse first = impact.momentum();
    const BodyState before = impact.body().state();
    const double size = length(first.linear), mass = impact.body().massOf().mass;
    SolidImpulse given;
    const std::atomic<bool> stop = false;
    for (int frame = 0; frame < 2; ++frame) {
      ASSERT_TRUE(impact.scene->advanceFrame(stop));
      given += {0.02 * impact.body().forces->solids.front().force,
                0.02 * impact.body().forces->solids.front().torque};
    }
    const BodyState after = impact.body().state();
    const SolidImpulse last = impact.momentum();
    EXPECT_GT(after.velocity.y, -0.5) << solver;
    // What it got is what is reported.
    EXPECT_NEAR(length(given.linear - mass * (after.velocity - before.velocity)) / size, 0, 1e-9) << solver;
    EXPECT_NEAR(length(given.angular - (after.spin - before.spin)) / (size * 0.1), 0, 1e-9) << solver;
    const double lost = length(last.linear - first.linear) / size,
                 turned = length(last.angular - first.angular) / (size * 0.1);
    std::printf("lost momentum: %.2g, angular %.2g\n", lost, turned);
    EXPECT_LT(lost, 1e-5) << solver;
    EXPECT_LT(turned, mostTurned(solver)) << solver;
  }
}

TEST(Floats, ProjectionsOnAllDevicesConserveMomentumAndTakeEnergyAway) {
  for (const std::string& name : availableDevices()) {
    Impact impact(kTwoProjections, 1, name);
    const SolidImpulse first = impact.momentum();
    double before = impact.kineticEnergy();
    const std::atomic<bool> stop = false;
    for (int frame = 0; frame < 4; ++frame) {
      ASSERT_TRUE(impact.scene->advanceFrame(stop));
      const double now = impact.kineticEnergy();
      EXPECT_LT(now, before) << name;
      before = now;
    }
    EXPECT_LT(length(impact.momentum().linear - first.linear) / length(first.linear), 1e-6) << name;
    // As on the CPU: 0.34 m/s.
    EXPECT_NEAR(impact.body().state().velocity.y, -0.341, 0.01) << name;
  }
}

/// So many that they are looked up in a grid, and summed by lists.
void expectManyToConserveMomentum(const std::string& solver) {
  constexpr int kCount = 18;
  Impact impact(solver, kCount);
  const SolidImpulse first = impact.momentum();
  double size = 0;
  for (int k = 0; k < kCount; ++k) size += impact.body(k).massOf().mass;  // at 1 m/s
  const std::atomic<bool> stop = false;
  for (int frame = 0; frame < 2; ++frame) ASSERT_TRUE(impact.scene->advanceFrame(stop));
  const SolidImpulse last = impact.momentum();
  for (int k = 0; k < kCount; ++k)
    EXPECT_LT(std::abs(impact.body(k).state().velocity.y), 0.9) << "body " << k << " has met no water";
  const double lost = length(last.linear - first.linear) / size,
               turned = length(last.angular - first.angular) / (size * 0.1);
  std::printf("lost momentum of %d bodies: %.2g, angular %.2g\n", kCount, lost, turned);
  EXPECT_LT(lost, 1e-5) << solver;
  EXPECT_LT(turned, mostTurned(solver)) << solver;
}

TEST(Floats, ManyBodiesConserveMomentumToo) {
  expectManyToConserveMomentum(R"("params": {"iterations": 800})");
  expectManyToConserveMomentum(kTwoProjections);
}

}  // namespace
}  // namespace weir::test
