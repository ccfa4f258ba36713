// Bodies in water: hydrostatics, any density, and the same bits.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "nodes/particle_fluid/particle_fluid.h"
#include "nodes/rigid_body/rigid_body.h"
#include "tests/support/devices.h"
#include "tests/support/expect_error.h"
#include "tests/support/resumed_scene.h"
#include "tests/support/simulated_scene.h"

namespace weir::test {
namespace {

constexpr double kGravity = 9.8, kWater = 1000, kDt = 0.005;
constexpr const char* kTwoProjections = R"("type": "TwoProjections")";

struct Pool {
  double side = 0.2, depth = 0.1;  // m
  double spacing = 0.02;           // m
  double cube = 0.1;               // m, its side
  double height = 0.1;             // m, of its centre
  double dt = kDt;
  std::string solver = R"("params": {"iterations": 15})";
  std::string body = R"("density": 500, "fixed_rotation": "xyz")";
  double gravity = kGravity;
  int restSteps = 200;
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
          "water": {{"type": "ParticleFluid", "params": {{"spacing": {}, "rest_steps": {}}},
                     "modules": {{"solver": {{{}}}, "viscosity": {{"params": {{"rate": {}}}}}}}}}}},
        "links": ["block.particles -> water.initial", "tank.boundary -> water.boundaries",
                  "tank.boundary -> body.walls", "water.fluid -> body.fluid", "cube.surface -> body.mesh"]}})",
      -pool.gravity, pool.dt, -pool.side / 2, -pool.side / 2, pool.side / 2, pool.depth, pool.side / 2,
      -pool.side / 2, -pool.side / 2, pool.side / 2, pool.side / 2, -pool.cube / 2, -pool.cube / 2,
      -pool.cube / 2, pool.cube / 2, pool.cube / 2, pool.cube / 2, pool.height, pool.body, pool.spacing,
      pool.restSteps, pool.solver, 0.3 / pool.dt);
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
    return (particles * std::pow(pool.spacing, 3) + draught * pool.cube * pool.cube) /
           (pool.side * pool.side);
  }

 private:
  std::unique_ptr<Device> device_;

 public:
  SimulatedScene scene;
};

/// The draught of a cube, over its side, in a pool of ten spacings. Water must be held
/// close to its density: by how much it is compressed, its level is lower.
double draughtOf(double density, double spacing,
                 const std::string& solver = R"("params": {"iterations": 40})") {
  Pool pool{.depth = 10 * spacing, .spacing = spacing, .dt = 0.1 * spacing, .solver = solver};
  pool.height = pool.depth + 0.25 * pool.cube;
  pool.body = fmt::format(R"("density": {}, "fixed_rotation": "xyz", "fixed": "xz")", density);
  Bathed run(pool);
  const double expected = density / kWater * pool.cube;
  run.advance(12);
  const Bathed::Motion motion = run.motionOver(6);
  EXPECT_LT(motion.speed, 0.15) << density;
  return (run.level(pool, expected) - (motion.height - pool.cube / 2)) / pool.cube;
}

/// The draught of a cube is its density's share of its side (Archimedes).
TEST(Floats, ACubeFloatsAsDeepAsItsDensity) {
  for (const double density : {100.0, 500.0, 900.0}) {
    const double draught = draughtOf(density, 0.02);
    std::printf("density %g, side of 5 spacings: draught of %.3f sides\n", density, draught);
    EXPECT_NEAR(draught, density / kWater, density < 900 ? 0.03 : 0.05) << density;
  }
}

TEST(Floats, ACubeOfManySpacingsFloatsAsDeepAsItsDensity) {
  const double draught = draughtOf(500, 0.0125, kTwoProjections);
  std::printf("density 500, side of 8 spacings: draught of %.3f sides\n", draught);
  EXPECT_NEAR(draught, 0.5, 0.04);
}

/// As light as it may be, at the water's own step: what an explicit exchange of forces makes explode.
TEST(Floats, LightBodiesDoNotExplode) {
  for (const std::string& solver : {Pool{}.solver, std::string(kTwoProjections)}) {
    Pool pool{.height = 0.16, .solver = solver};
    pool.body = R"("density": 10)";
    Bathed run(pool);
    double fastest = 0, highest = 0;
    for (int k = 0; k < 20; ++k) {
      run.advance(1);
      fastest = std::max(fastest, length(run.state().velocity));
      highest = std::max(highest, run.state().center.y);
    }
    EXPECT_LT(fastest, 1) << solver;
    EXPECT_LT(highest, 0.2) << solver;
    EXPECT_NEAR(run.state().center.y, 0.1 + 0.04, 0.03) << solver;
  }
}

/// Twenty times as heavy as water, it sinks to the ground and lies there.
TEST(Floats, HeavyBodiesSinkAndLie) {
  Pool pool{.depth = 0.2, .height = 0.16};
  pool.body = R"("density": 20000, "restitution": 0)";
  Bathed run(pool);
  run.advance(15);
  EXPECT_NEAR(run.state().center.y, pool.cube / 2, 1e-3);
  EXPECT_LT(run.motionOver(5).speed, 0.02);
}

/// A ball or a cube of a litre in a tank of twelve spacings, over half a second.
struct Submerged {
  explicit Submerged(const std::string& body, const std::string& shape = ball())
      : device_(openDevice("cpu")), scene(*device_, textWith(body, shape)) {
    scene->reset();
    const std::atomic<bool> stop = false;
    for (int frame = 0; frame < 10; ++frame) {
      scene->advanceFrame(stop);
      lifts.push_back(lift());
    }
  }
  const RigidBody& body() { return scene.node<RigidBody>("ball"); }
  /// The force on it in the last frame, over the weight of the water in its place.
  Vec3d lift() {
    return body().forces->solids.front().force / (kGravity * kWater / 1000 * body().massOf().mass);
  }

  static constexpr double kHeight = 0.12, kSpacing = 0.02;

  static std::string cube() {
    return R"({"type": "BoxMesh", "params": {"min": [-0.05, -0.05, -0.05], "max": [0.05, 0.05, 0.05]}})";
  }
  static std::string ball() {
    constexpr int kPoints = 24;
    constexpr double kRadius = 0.062;
    std::string profile;
    for (int k = 0; k <= kPoints; ++k) {
      const double angle = std::numbers::pi * (double(k) / kPoints - 0.5);
      const bool pole = k == 0 || k == kPoints;
      profile += fmt::format("{}[{:.6f}, {:.6f}]", k == 0 ? "" : ", ", pole ? 0 : kRadius * std::cos(angle),
                             kRadius * std::sin(angle));
    }
    return fmt::format(R"({{"type": "TurningModel", "params": {{"profile": [{}], "segments": 32}}}})",
                       profile);
  }

 private:
  static std::string textWith(const std::string& body, const std::string& shape) {
    return fmt::format(
        R"({{"weir": 1, "world": {{"gravity": [0, -{}, 0], "dt": 0.001, "frame_rate": 20, "duration": 5}},
          "nodes": {{
            "block": {{"type": "BoxSampler", "params": {{"min": [-0.12, 0, -0.12], "max": [0.12, 0.24, 0.12]}}}},
            "tank": {{"type": "StaticBoundary", "params": {{"shape": "box", "inverted": true,
                                                          "min": [-0.12, 0, -0.12], "max": [0.12, 2, 0.12]}}}},
            "shape": {},
            "ball": {{"type": "RigidBody", "params": {{"density": 1000, "position": [0, {}, 0]{}}}}},
            "water": {{"type": "ParticleFluid", "params": {{"spacing": {}, "rest_steps": 200}},
                       "modules": {{"solver": {{"params": {{"iterations": 40}}}}}}}}}},
          "links": ["block.particles -> water.initial", "tank.boundary -> water.boundaries",
                    "tank.boundary -> ball.walls", "water.fluid -> ball.fluid", "shape.surface -> ball.mesh"]}})",
        kGravity, shape, kHeight, body, kSpacing);
  }
  std::unique_ptr<Device> device_;

 public:
  SimulatedScene scene;
  std::vector<Vec3d> lifts;  // of all frames
};

/// Archimedes. Water at rest bears some stress in whatever arrangement it came to: so it does to the side.
TEST(Floats, AHeldBallIsLiftedByTheWeightOfItsWater) {
  Submerged run(R"(, "fixed": "xyz", "fixed_rotation": "xyz")");
  const Vec3d lift = run.lift();
  std::printf("lift of a held ball: %.4f, to the side %.4f\n", lift.y, std::hypot(lift.x, lift.z));
  EXPECT_NEAR(lift.y, 1, 0.03);
  EXPECT_NEAR(std::hypot(lift.x, lift.z), 0, 0.05);
}

/// The same at sharp edges, where water comes to rest, too.
TEST(Floats, AHeldCubeIsLiftedByTheWeightOfItsWaterAndQuietly) {
  for (const char* turned : {"", R"(, "rotation": [10, 20, 30])"}) {
    const Submerged run(R"(, "fixed": "xyz", "fixed_rotation": "xyz")" + std::string(turned),
                        Submerged::cube());
    double least = 10, most = 0, mean = 0;
    for (std::size_t k = 3; k < run.lifts.size(); ++k) {
      least = std::min(least, run.lifts[k].y), most = std::max(most, run.lifts[k].y);
      mean += run.lifts[k].y / double(run.lifts.size() - 3);
    }
    std::printf("lift of a held cube: %.3f to %.3f, mean %.3f\n", least, most, mean);
    EXPECT_NEAR(mean, 1, 0.03);
    EXPECT_LT(most - least, 0.1);
  }
}

/// Of water's density it goes where water goes: nowhere.
TEST(Floats, ABallOfWatersDensityStays) {
  Submerged run("");
  const BodyState state = run.body().state();
  const double drift = length(state.center - Vec3d{0, Submerged::kHeight, 0});
  std::printf("a ball of water's density has drifted by %.2g m in 0.5 s\n", drift);
  EXPECT_LT(drift, 0.25 * Submerged::kSpacing);
  EXPECT_LT(length(state.velocity), 0.03);
}

/// What holds still is a wall: forces on it are those on a solid that does not move.
TEST(Floats, AHeldBodyFeelsWhatASolidAtRestFeels) {
  Pool pool{.height = 0.12};
  pool.body = R"("density": 500, "fixed": "xyz", "fixed_rotation": "xyz")";
  pool.restSteps = 50;
  Bathed run(pool);
  std::string scene = sceneOf(pool);
  const auto replace = [&](const std::string& from, const std::string& to) {
    scene.replace(scene.find(from), from.size(), to);
  };
  replace("RigidBody", "SemiAnalyticalSFI");
  replace(", " + pool.body, "");
  replace(R"("tank.boundary -> body.walls", )", "");
  replace("cube.surface -> body.mesh", "cube.surface -> body.solids");
  const auto device = openDevice("cpu", 1);
  SimulatedScene still(*device, scene);
  still->reset();
  const std::atomic<bool> stop = false;
  for (int frame = 0; frame < 3; ++frame) {
    run.advance(1);
    ASSERT_TRUE(still->advanceFrame(stop));
    const SolidForces::OfSolid &held = run.body().forces->solids.front(),
                               &solid = still.node<SemiAnalyticalSFI>("body").forces->solids.front();
    const double weight = kWater * kGravity * std::pow(pool.cube, 3);
    EXPECT_GT(solid.force.y, 0.1 * weight);
    EXPECT_NEAR(length(held.force - solid.force) / weight, 0, 1e-4);
  }
  EXPECT_EQ(run.state().center.y, double(float(pool.height)));
  EXPECT_EQ(length(run.state().velocity), 0);
}

TEST(Floats, StepsAllocateNothingAndReadNothingBack) {
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    SimulatedScene scene(*device, sceneOf({.height = 0.12}), {"water.rest_steps=20", "world.frame_rate=10"});
    scene->reset();
    const std::atomic<bool> stop = false;
    std::vector<std::uint64_t> allocations, readbacks;
    for (int frame = 0; frame < 2; ++frame)
      scene->advanceFrame(stop, [&] {
        allocations.push_back(device->memoryUse().allocations);
        readbacks.push_back(device->blockingReadbacks());
      });
    // Within a frame; between frames there is a report.
    ASSERT_EQ(allocations.size(), 40u);
    EXPECT_EQ(allocations[21], allocations[38]) << name;
    EXPECT_EQ(readbacks[21], readbacks[38]) << name;
  }
}

TEST(Floats, TheSameBitsForAnyInstructions) {
  Pool pool;
  pool.height = 0.12;
  pool.body = R"("density": 300, "rotation": [10, 20, 30])";
  const std::atomic<bool> stop = false;
  std::vector<BodyState> found;
  for (const CpuIsa isa : usableCpuIsas()) {
    CpuDevice device(1, isa);
    SimulatedScene scene(device, sceneOf(pool), {"water.rest_steps=20", "world.frame_rate=50"});
    scene->reset();
    for (int k = 0; k < 5; ++k) scene->advanceFrame(stop);
    found.push_back(scene.node<RigidBody>("body").state());
    EXPECT_EQ(found.back().center, found.front().center) << cpuIsaName(isa);
    EXPECT_EQ(found.back().spin, found.front().spin) << cpuIsaName(isa);
  }
}

/// Of a cube that is turned, and comes to float.
Pool turnedIn(const std::string& solver) {
  Pool pool{.height = 0.12, .solver = solver};
  pool.body = R"("density": 200, "rotation": [10, 20, 30])";
  return pool;
}

TEST(Floats, TheSameBitsForAnyNumberOfThreads) {
  for (const std::string& solver : {Pool{}.solver, std::string(kTwoProjections)}) {
    Bathed one(turnedIn(solver), "cpu", 1), four(turnedIn(solver), "cpu", 4);
    one.advance(5);
    four.advance(5);
    EXPECT_EQ(one.state().center, four.state().center) << solver;
    EXPECT_EQ(one.state().rotation, four.state().rotation) << solver;
    EXPECT_EQ(one.state().velocity, four.state().velocity) << solver;
    EXPECT_EQ(one.state().spin, four.state().spin) << solver;
  }
}

TEST(Floats, GoesOnBitByBitWhereItIsResumed) {
  for (const std::string& solver : {Pool{}.solver, std::string(kTwoProjections)})
    EXPECT_EQ(resumedSceneDifferences(sceneOf(turnedIn(solver)), {.savedAt = 2, .comparedFor = 2}),
              std::vector<std::string>{})
        << solver;
}

/// Twenty small cubes of three densities on a pool.
std::string manyOnWater() {
  return R"scene({"weir": 1, "let": {"bodies": 20},
    "world": {"gravity": [0, -9.8, 0], "dt": 0.004, "frame_rate": 50, "duration": 5},
    "nodes": {
      "block": {"type": "BoxSampler", "params": {"min": [-0.16, 0, -0.12], "max": [0.16, 0.08, 0.12]}},
      "tank": {"type": "StaticBoundary", "params": {"shape": "box", "inverted": true,
                                                    "min": [-0.16, 0, -0.12], "max": [0.16, 2, 0.12]}},
      "cube": {"type": "BoxMesh", "params": {"min": [-0.02, -0.02, -0.02], "max": [0.02, 0.02, 0.02]}},
      "body_{k}": {"repeat": "=bodies", "as": "k", "node": {"type": "RigidBody", "params": {
        "density": "=200+300*(k-3*floor(k/3))", "rotation": [10, "=0.5*k", 5],
        "position": ["=-0.126+0.063*(k-5*floor(k/5))", 0.085, "=-0.09+0.06*floor(k/5)"]}}},
      "water": {"type": "ParticleFluid", "params": {"spacing": 0.02, "rest_steps": 10},
                "modules": {"solver": {"type": "SemiImplicitSolver", "params": {"iterations": 15}}}}},
    "links": ["block.particles -> water.initial", "tank.boundary -> water.boundaries",
      {"repeat": "=bodies", "as": "k", "item": "tank.boundary -> body_{k}.walls"},
      {"repeat": "=bodies", "as": "k", "item": "water.fluid -> body_{k}.fluid"},
      {"repeat": "=bodies", "as": "k", "item": "cube.surface -> body_{k}.mesh"}]})scene";
}

TEST(Floats, ManyHaveTheSameBitsForAnyNumberOfThreads) {
  const auto one = openDevice("cpu", 1), four = openDevice("cpu", 4);
  SimulatedScene first(*one, manyOnWater()), second(*four, manyOnWater());
  const std::atomic<bool> stop = false;
  for (SimulatedScene* scene : {&first, &second}) {
    (*scene)->reset();
    for (int k = 0; k < 3; ++k) (*scene)->advanceFrame(stop);
  }
  for (int k = 0; k < 20; ++k) {
    const std::string name = fmt::format("body_{}", k);
    RigidBody &a = first.node<RigidBody>(name.c_str()), &b = second.node<RigidBody>(name.c_str());
    EXPECT_EQ(a.state().center, b.state().center) << name;
    EXPECT_EQ(a.state().rotation, b.state().rotation) << name;
    EXPECT_EQ(a.state().velocity, b.state().velocity) << name;
    EXPECT_EQ(a.state().spin, b.state().spin) << name;
    EXPECT_GT(a.forces->solids.front().force.y, 0) << name;
  }
}

TEST(Floats, ManyGoOnBitByBitWhereTheyAreResumed) {
  EXPECT_EQ(resumedSceneDifferences(manyOnWater(), {.savedAt = 2, .comparedFor = 2}),
            std::vector<std::string>{});
}

TEST(Floats, WhatCannotMoveBodiesIsRefused) {
  const auto refusalOf = [](const std::string& solver, const std::string& change = "world.duration=5") {
    Pool pool;
    pool.solver = solver;
    return std::string(errorOf([&] {
                         const auto device = openDevice("cpu");
                         SimulatedScene scene(*device, sceneOf(pool), {change});
                         scene->reset();
                       }).what());
  };
  EXPECT_CONTAINS(refusalOf(R"("type": "Pbf")"),
                  "node 'water', in which the body is, has no solver that moves bodies");
  EXPECT_CONTAINS(refusalOf(R"("type": "AcceleratedSolver", "params": {"acceleration": "conjugate"})"),
                  "conjugate gradients do not move bodies");
  EXPECT_CONTAINS(refusalOf(R"("params": {"iterations": 3}}, "contact": {"enabled": false)"),
                  "enabled modules SolidApproach, WallIntegrals and SolidContact");
  EXPECT_CONTAINS(
      refusalOf(R"("params": {"iterations": 3}}, "thick": {"type": "ViscositySolver", "after": "walls")"),
      "which does not drag bodies yet");
  EXPECT_CONTAINS(refusalOf(R"("params": {"iterations": 3})", "body.position=[1, 0.1, 0]"),
                  "m deep within its walls");
}

/// Two cubes in a pool, of which the other is given.
std::string withAnother(const std::string& other, const std::string& input) {
  std::string scene =
      sceneOf({.side = 0.4, .height = 0.12, .body = R"("density": 500, "velocity": [1, 0, 0])"});
  const auto insert = [&](const std::string& before, const std::string& text) {
    scene.insert(scene.find(before), text);
  };
  insert(R"("water": {)", R"("other": )" + other + ", ");
  insert(R"("water.fluid -> body.fluid")",
         fmt::format(R"("water.fluid -> other.fluid", "cube.surface -> other.{}", )", input));
  return scene;
}

TEST(Floats, BodiesThatMeetOthersEndTheRun) {
  const auto device = openDevice("cpu");
  const auto errorWith = [&](const std::string& other, const std::string& input, int frames) {
    return std::string(errorOf([&] {
                         SimulatedScene scene(*device, withAnother(other, input), {"water.rest_steps=5"});
                         scene->reset();
                         const std::atomic<bool> stop = false;
                         for (int k = 0; k < frames; ++k) scene->advanceFrame(stop);
                       }).what());
  };
  EXPECT_CONTAINS(
      errorWith(R"({"type": "SemiAnalyticalSFI", "params": {"position": [0.14, 0.12, 0.01]}})", "solids", 10),
      "the body has met 'other' at 0.");
  EXPECT_CONTAINS(
      errorWith(R"({"type": "RigidBody", "params": {"density": 500, "position": [0.14, 0.12, 0.01]}})",
                "mesh", 10),
      "the body has met 'other' at 0.");
  EXPECT_CONTAINS(
      errorWith(R"({"type": "RigidBody", "params": {"density": 500, "position": [0.05, 0.1, 0.01]}})", "mesh",
                0),
      "the body has met 'other' at 0 s, which does not hold it");
}

TEST(Floats, WarnsOfWallsThatDoNotHoldIt) {
  std::string scene = sceneOf({.height = 0.12});
  const std::string link = R"("tank.boundary -> body.walls", )";
  scene.erase(scene.find(link), link.size());
  const auto device = openDevice("cpu");
  SimulatedScene run(*device, scene, {"water.rest_steps=0"});
  run->reset();
  const auto isTold = [](const std::string& warning) {
    return warning.find(
               "'tank' holds the fluid but not the body, which passes through it; the link "
               "tank.boundary -> body.walls makes it hold both") != std::string::npos;
  };
  EXPECT_EQ(std::count_if(run.warnings().begin(), run.warnings().end(), isTold), 1);
}

}  // namespace
}  // namespace weir::test
