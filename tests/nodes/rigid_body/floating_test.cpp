// Bodies in water: hydrostatics, added mass, conservation, any density, and the same bits.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <numbers>

#include "framework/run/resume_check.h"
#include "nodes/particle_fluid/particle_fluid.h"
#include "nodes/rigid_body/rigid_body.h"
#include "tests/support/devices.h"
#include "tests/support/expect_error.h"
#include "tests/support/simulated_scene.h"

namespace weir::test {
namespace {

constexpr double kGravity = 9.8, kWater = 1000, kDt = 0.005;

struct Pool {
  double side = 0.2, depth = 0.1;  // m
  double spacing = 0.02;           // m
  double cube = 0.1;               // m, its side
  double height = 0.1;             // m, of its centre
  double dt = kDt;
  std::string solver = R"("params": {"iterations": 15})";
  std::string body = R"("density": 500, "fixed_rotation": "xyz")";
  double gravity = kGravity;
};

/// A cube in a pool with walls by signed distance.
std::string sceneOf(const Pool& pool) {
  return fmt::format(
      R"({{"weir": 1, "world": {{"gravity": [0, {}, 0], "dt": {}, "frame_rate": 20, "duration": 5}},
        "nodes": {{
          "block": {{"type": "BoxSampler", "params": {{"min": [{}, 0, {}], "max": [{}, {}, {}]}}}},
          "tank": {{"type": "StaticBoundary",
                    "params": {{"shape": "box", "inverted": true, "min": [{}, 0, {}], "max": [{}, 2, {}]}}}},
          "cube": {{"type": "BoxMesh", "params": {{"min": [{}, {}, {}], "max": [{}, {}, {}]}}}},
          "body": {{"type": "RigidBody", "params": {{"position": [0, {}, 0], {}}}}},
          "water": {{"type": "ParticleFluid", "params": {{"spacing": {}}},
                     "modules": {{"solver": {{{}}}}}}}}},
        "links": ["block.particles -> water.initial", "tank.boundary -> water.boundaries",
                  "tank.boundary -> body.walls", "water.fluid -> body.fluid", "cube.surface -> body.mesh"]}})",
      -pool.gravity, pool.dt, -pool.side / 2, -pool.side / 2, pool.side / 2, pool.depth, pool.side / 2,
      -pool.side / 2, -pool.side / 2, pool.side / 2, pool.side / 2, -pool.cube / 2, -pool.cube / 2,
      -pool.cube / 2, pool.cube / 2, pool.cube / 2, pool.cube / 2, pool.height, pool.body, pool.spacing,
      pool.solver);
}

struct Bathed {
  explicit Bathed(const Pool& pool, const std::string& device = "cpu", int threads = 1)
      : device_(openDevice(device, threads)), scene(*device_, sceneOf(pool)) {
    scene->reset();
  }
  const RigidBody& body() { return scene.node<RigidBody>("body"); }
  BodyState state() { return body().state(); }
  void advance(int frames) {
    const std::atomic<bool> stop = false;
    for (int k = 0; k < frames; ++k) ASSERT_TRUE(scene->advanceFrame(stop));
  }
  /// The largest speed of its centre, and the mean of its height, over frames to come.
  struct Motion {
    double speed = 0, height = 0;
  };
  Motion motionOver(int frames) {
    Motion motion;
    for (int k = 0; k < frames; ++k) {
      advance(1);
      motion.speed = std::max(motion.speed, length(state().velocity));
      motion.height += state().center.y / frames;
    }
    return motion;
  }
  /// Where the water's surface is, by its volume and the body's.
  double level(const Pool& pool, double draught) {
    const double particles = double(scene.node<ParticleFluid>("water").particleCount());
    return (particles * std::pow(pool.spacing, 3) + draught * pool.cube * pool.cube) / (pool.side * pool.side);
  }

 private:
  std::unique_ptr<Device> device_;

 public:
  SimulatedScene scene;
};

/// The draught of a cube is its density's share of its side (Archimedes), within 3 % of the side.
TEST(Floats, ACubeFloatsAsDeepAsItsDensity) {
  for (const double density : {500.0, 100.0}) {
    Pool pool;
    pool.height = 0.1 + 0.03 - (density / kWater - 0.5) * pool.cube;
    pool.body = fmt::format(R"("density": {}, "fixed_rotation": "xyz", "fixed": "xz")", density);
    Bathed run(pool);
    const double draught = density / kWater * pool.cube;
    run.advance(20);
    const Bathed::Motion motion = run.motionOver(10);
    const double found = run.level(pool, draught) - (motion.height - pool.cube / 2);
    EXPECT_NEAR(found / pool.cube, density / kWater, 0.03) << density;
    EXPECT_LT(motion.speed, 0.1) << density;
  }
}

/// As light as it may be, at the water's own step: what an explicit exchange of forces makes explode.
TEST(Floats, LightBodiesDoNotExplode) {
  Pool pool;
  pool.height = 0.16;
  pool.body = R"("density": 10)";
  Bathed run(pool);
  double fastest = 0, highest = 0;
  for (int k = 0; k < 20; ++k) {
    run.advance(1);
    fastest = std::max(fastest, length(run.state().velocity));
    highest = std::max(highest, run.state().center.y);
  }
  EXPECT_LT(fastest, 1);
  EXPECT_LT(highest, 0.2);
  EXPECT_NEAR(run.state().center.y, 0.1 + 0.04, 0.03);
}

/// Of water's density it goes where water goes: nowhere.
TEST(Floats, NeutralDensityStays) {
  Pool pool{.side = 0.24, .depth = 0.24, .height = 0.12};
  pool.body = R"("density": 1000)";
  Bathed run(pool);
  run.advance(20);
  EXPECT_NEAR(run.state().center.y, 0.12, 0.1 * pool.cube);
  EXPECT_LT(length(run.state().velocity), 0.05);
}

/// All that happens is between the water and the body: their momentum is that of the start.
TEST(Floats, MomentumIsConservedWithoutGravity) {
  // Without walls, and with a body that flies into a block of water.
  const char* const kScene = R"({"weir": 1,
    "world": {"gravity": [0, 0, 0], "dt": 0.002, "frame_rate": 50, "duration": 1},
    "nodes": {
      "block": {"type": "BoxSampler", "params": {"min": [-0.1, -0.1, -0.1], "max": [0.1, 0.1, 0.1]}},
      "cube": {"type": "BoxMesh", "params": {"min": [-0.05, -0.05, -0.05], "max": [0.05, 0.05, 0.05]}},
      "body": {"type": "RigidBody",
               "params": {"density": 300, "position": [0.02, 0.16, 0.01], "velocity": [0, -1, 0]}},
      "water": {"type": "ParticleFluid", "params": {"spacing": 0.02, "rest_steps": 0},
                "modules": {"solver": {"type": "AcceleratedSolver", "params": {"tolerance": 1e-5}},
                            "viscosity": {"enabled": false}}}},
    "links": ["block.particles -> water.initial", "water.fluid -> body.fluid", "cube.surface -> body.mesh"]})";
  const auto device = openDevice("cpu", 1);
  SimulatedScene scene(*device, kScene);
  scene->reset();
  const RigidBody& body = scene.node<RigidBody>("body");
  const ParticleFluid& water = scene.node<ParticleFluid>("water");
  const double mass = water.constants().particleMass;
  Vec3d given;
  const BodyState before = body.state();
  const std::atomic<bool> stop = false;
  for (int k = 0; k < 10; ++k) {
    ASSERT_TRUE(scene->advanceFrame(stop));
    given += 0.02 * body.forces->solids.front().force;
  }
  const BodyState after = body.state();
  Vec3d momentum = body.massOf().mass * after.velocity;
  for (const Vec3f& v : (*water.fluid).set().velocities().toHost(water.particleCount())) momentum += mass * inDouble(v);
  const double size = body.massOf().mass * length(before.velocity);
  EXPECT_LT(after.velocity.y, -0.1);
  EXPECT_GT(after.velocity.y, -0.9);
  // What it got is what is reported, exactly; and what the water lost, but for what its solver leaves.
  EXPECT_NEAR(length(given - body.massOf().mass * (after.velocity - before.velocity)) / size, 0, 1e-9);
  EXPECT_NEAR(length(momentum - body.massOf().mass * before.velocity) / size, 0, 1e-5);
}

TEST(Floats, TheSameBitsForAnyNumberOfThreads) {
  Pool pool;
  pool.height = 0.12;
  pool.body = R"("density": 200, "rotation": [10, 20, 30])";
  Bathed one(pool, "cpu", 1), three(pool, "cpu", 3);
  one.advance(5);
  three.advance(5);
  EXPECT_EQ(one.state().center, three.state().center);
  EXPECT_EQ(one.state().rotation, three.state().rotation);
  EXPECT_EQ(one.state().velocity, three.state().velocity);
  EXPECT_EQ(one.state().spin, three.state().spin);
}

TEST(Floats, GoesOnBitByBitWhereItIsResumed) {
  Pool pool;
  pool.height = 0.12;
  pool.body = R"("density": 200, "rotation": [10, 20, 30])";
  const auto device = openDevice("cpu", 2);
  Log log;
  Registry registry;
  registerNodes(registry);
  const auto make = [&] {
    std::vector<std::string> ignored;
    auto built = buildScene(parseJson(sceneOf(pool), "test"), {"test", "", "/"}, registry, {}, ignored);
    return std::make_unique<Simulation>(std::move(built), *device, log, registry);
  };
  EXPECT_EQ(resumeDifferences(make, {.savedAt = 2, .comparedFor = 2}), std::vector<std::string>{});
}

TEST(Floats, WhatCannotMoveBodiesIsRefused) {
  const auto refusalOf = [](const std::string& solver) {
    Pool pool;
    pool.solver = solver;
    return std::string(errorOf([&] {
                         Bathed run(pool);
                         const std::atomic<bool> stop = false;
                         run.scene->advanceFrame(stop);
                       }).what());
  };
  EXPECT_CONTAINS(refusalOf(R"("type": "Pbf")"), "no solver of it moves bodies");
  EXPECT_CONTAINS(refusalOf(R"("type": "AcceleratedSolver", "params": {"acceleration": "conjugate"})"),
                  "conjugate gradients do not move bodies");
}

}  // namespace
}  // namespace weir::test
