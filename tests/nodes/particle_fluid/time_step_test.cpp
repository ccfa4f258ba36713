// Steps that follow the motion of a fluid: how many there are, how far particles get in one, and that the
// same run comes out each time.
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "framework/particles/flight.h"
#include "nodes/particle_fluid/particle_fluid.h"
#include "tests/support/devices.h"
#include "tests/support/simulated_scene.h"

namespace weir::test {
namespace {

const std::atomic<bool> kGoOn = false;

TEST(TimeToFly, SolvesTheWayOfOneStep) {
  for (const double speed : {0.0, 1e-6, 3.0, 200.0})
    for (const double acceleration : {0.0, 9.8, 1e4}) {
      const double dt = timeToFly(0.004, speed, acceleration);
      if (speed + acceleration > 0)
        EXPECT_NEAR(speed * dt + acceleration * dt * dt, 0.004, 1e-12) << speed << " " << acceleration;
      else
        EXPECT_EQ(dt, std::numeric_limits<double>::infinity());
    }
}

using FluidTimeStep = OnDevice;
WEIR_ON_EVERY_DEVICE(FluidTimeStep);

constexpr const char* kFallingBlock = R"({
  "weir": 1,
  "world": { "gravity": [0, 0, -10], "dt": 0.5, "cfl": 0.5, "frame_rate": 1, "duration": 1 },
  "nodes": {
    "block": { "type": "BoxSampler", "params": { "min": [0, 0, 0], "max": [0.1, 0.1, 0.1] } },
    "water": { "type": "ParticleFluid", "params": { "spacing": 0.02 },
               "modules": { "solver": { "enabled": false } } }
  },
  "links": [ "block.particles -> water.initial" ]
})";

TEST_P(FluidTimeStep, AFallingBlockTakesTheStepsOfItsWay) {
  SimulatedScene scene(*device, kFallingBlock);
  scene->reset();
  double time = 0;
  ASSERT_TRUE(scene->advanceFrame(kGoOn, [&] {
    // v = g·t as long as nothing is in the way, so a step may be d/2 over it.
    const double next = scene->time(), dt = next - time, speed = 10 * time;
    EXPECT_LE(speed * dt + 10 * dt * dt, 0.01 * (1 + 1e-4)) << time;
    time = next;
  }));
  EXPECT_EQ(scene->time(), 1);
  // It falls g·t²/2 = 5 m in steps of 1 cm at most; dividing the rest evenly costs a few more.
  EXPECT_GE(scene->stepsDone(), 500);
  EXPECT_LE(scene->stepsDone(), 515);
  NodeReport report;
  scene.node<ParticleFluid>("water").report(report);
  EXPECT_NEAR(report.statistics.find("max_speed")->asDouble(), 10, 1e-3);
}

constexpr const char* kJet = R"({
  "weir": 1,
  "world": { "dt": 0.005, "cfl": 0.4, "frame_rate": 200, "duration": 0.02 },
  "nodes": {
    "nozzle": { "type": "SquareEmitter",
                "params": { "position": [0, 1, 0], "width": 0.08, "height": 0.08, "start": 0.007,
                            "speed": { "keyframes": [[0, 1], [0.007, 1], [0.011, 50]] } } },
    "water": { "type": "ParticleFluid", "params": { "spacing": 0.02 },
               "modules": { "solver": { "enabled": false }, "viscosity": { "enabled": false } } }
  },
  "links": [ "nozzle.particles -> water.emitters" ]
})";

std::map<std::int64_t, Vec3f> positionsById(ParticleSet& particles) {
  const std::int64_t n = particles.refreshCount();
  const std::vector<std::int64_t> ids = particles.ids().toHost(n);
  const std::vector<Vec3f> positions = particles.positions().toHost(n);
  std::map<std::int64_t, Vec3f> byId;
  for (std::size_t k = 0; k < ids.size(); ++k) byId[ids[k]] = positions[k];
  return byId;
}

TEST_P(FluidTimeStep, AFastJetMovesNoFartherThanAllowed) {
  SimulatedScene scene(*device, kJet);
  scene->reset();
  ParticleSet& particles = scene.node<ParticleFluid>("water").fluid->set();
  std::map<std::int64_t, Vec3f> before;
  double farthest = 0, time = 0;
  while (scene->advanceFrame(kGoOn, [&] {
    const std::map<std::int64_t, Vec3f> after = positionsById(particles);
    for (const auto& [id, position] : after)
      if (before.contains(id)) farthest = std::max(farthest, double(length(position - before[id])));
    // Those just born have moved by the jet's speed, which is at most that at the end of the step.
    const double next = scene->time();
    if (next > 0.007 && time < 0.02) {
      const double speed = next < 0.011 ? 1 + 49 * (next - 0.007) / 0.004 : 50;
      EXPECT_LE(speed * (next - time), 0.4 * 0.02 * (1 + 1e-4)) << next;
    }
    before = after;
    time = next;
  })) {
  }
  EXPECT_GT(before.size(), 16u * 10);
  EXPECT_LE(farthest, 0.4 * 0.02 * (1 + 1e-4));
  EXPECT_GT(farthest, 0.9 * 0.4 * 0.02);  // and steps are not shorter than need be
  EXPECT_EQ(scene->stepLengths().tooLong, 0);
  EXPECT_EQ(scene->stepLengths().longest, 0.005);  // before the flow starts, nothing moves
}

TEST_P(FluidTimeStep, AnExhaustedOrStoppedEmitterAsksForNothing) {
  for (const char* change : {"nozzle.max_particles=0", "nozzle.stop=0.007", "nozzle.start=5"}) {
    SimulatedScene scene(*device, kJet, {change});
    scene->reset();
    while (scene->advanceFrame(kGoOn)) {
    }
    EXPECT_EQ(scene->stepsDone(), 4) << change;
  }
}

constexpr const char* kSplash = R"({
  "weir": 1,
  "world": { "dt": 0.005, "cfl": 0.4, "frame_rate": 25, "duration": 0.2,
             "gravity": { "keyframes": [[0, [0, -9.8, 0]], [0.1, [4, -9.8, 0]], [0.2, [-4, -9.8, 0]]] } },
  "nodes": {
    "block": { "type": "BoxSampler", "params": { "min": [0, 0.1, 0], "max": [0.2, 0.3, 0.2] } },
    "nozzle": { "type": "SquareEmitter",
                "params": { "position": [0.3, 0.4, 0.1], "width": 0.08, "height": 0.08, "speed": 2 } },
    "tank": { "type": "StaticBoundary",
              "params": { "shape": "box", "min": [0, 0, 0], "max": [0.5, 0.5, 0.2], "inverted": true } },
    "water": { "type": "ParticleFluid", "params": { "spacing": 0.02 },
               "modules": {"solver": {"type": "SemiImplicitSolver"}}}
  },
  "links": [ "block.particles -> water.initial", "nozzle.particles -> water.emitters",
             "tank.boundary -> water.boundaries" ]
})";

struct Outcome {
  std::int64_t steps;
  Simulation::StepLengths lengths;
  std::map<std::int64_t, Vec3f> positions;
};

Outcome splashOn(Device& device) {
  SimulatedScene scene(device, kSplash);
  scene->reset();
  while (scene->advanceFrame(kGoOn)) {
  }
  return {scene->stepsDone(), scene->stepLengths(),
          positionsById(scene.node<ParticleFluid>("water").fluid->set())};
}

void expectSame(const Outcome& a, const Outcome& b) {
  EXPECT_EQ(a.steps, b.steps);
  EXPECT_EQ(a.lengths.shortest, b.lengths.shortest);
  EXPECT_EQ(a.lengths.longest, b.lengths.longest);
  EXPECT_TRUE(a.positions == b.positions);
}

TEST_P(FluidTimeStep, ASplashComesOutTheSameEachTime) {
  const Outcome first = splashOn(*device);
  EXPECT_LT(first.lengths.shortest, 0.9 * first.lengths.longest);
  expectSame(splashOn(*device), first);
}

TEST(FluidTimeStepOnCpu, TheNumberOfThreadsDoesNotMatter) {
  CpuDevice one(1), two(2), three(3);
  const Outcome first = splashOn(one);
  expectSame(splashOn(two), first);
  expectSame(splashOn(three), first);
}

constexpr const char* kSloshing = R"({
  "weir": 1,
  "world": { "dt": 0.001, "frame_rate": 100, "duration": 0.4,
             "gravity": { "keyframes": [[0, [0, 0, 0]], [0.4, [8, -4, 0]]] } },
  "nodes": {
    "block": { "type": "BoxSampler", "params": { "min": [0, 0, 0], "max": [0.1, 0.1, 0.1] } },
    "water": { "type": "ParticleFluid", "params": { "spacing": 0.02 },
               "modules": { "solver": { "enabled": false } } }
  },
  "links": [ "block.particles -> water.initial" ]
})";

TEST_P(FluidTimeStep, GravityFollowsItsKeyframes) {
  for (const char* change : {"title=equal steps", "world.cfl=0.05"}) {
    SimulatedScene scene(*device, kSloshing, {change});
    scene->reset();
    while (scene->advanceFrame(kGoOn)) {
    }
    // v = ∫ g dt, with g as it is at the beginning of each step, so dt·g/2 less.
    NodeReport report;
    ParticleFluid& water = scene.node<ParticleFluid>("water");
    water.report(report);
    const std::vector<Vec3f> velocities = water.fluid->set().velocities().toHost(water.particleCount());
    for (const Vec3f& v : velocities) {
      EXPECT_NEAR(v.x, 0.5 * 8 * 0.4, 0.006) << change;
      EXPECT_NEAR(v.y, -0.5 * 4 * 0.4, 0.003) << change;
      EXPECT_EQ(v.z, 0);
    }
    // The energy in the field of gravity uses that of the time.
    const auto& center = report.statistics.find("center_of_mass")->asArray();
    const double mass = 125 * 1000 * std::pow(0.02, 3);
    EXPECT_NEAR(report.statistics.find("potential_energy")->asDouble(),
                -mass * (8 * center[0].asDouble() - 4 * center[1].asDouble()), 1e-4);
  }
}

}  // namespace
}  // namespace weir::test
