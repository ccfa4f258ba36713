// Tolerance, momentum, walls and repeated searches of the solver where they are hard: long steps, stiff
// fluid, impacts.
#include <gtest/gtest.h>

#include "nodes/static_boundary/static_boundary.h"
#include "tests/nodes/particle_fluid/modules/module_test_support.h"

namespace weir::test {
namespace {

constexpr float kSpacing = 0.04f;
constexpr double kStiff = 1e7;  // Pa

std::vector<Vec3d> toDoubles(const std::vector<Vec3f>& vectors) {
  std::vector<Vec3d> result;
  for (const Vec3f& v : vectors) result.push_back(toDouble(v));
  return result;
}

FluidScene fluidWith(Device& device, const std::vector<Vec3f>& positions,
                     const std::vector<Vec3f>& velocities, Value solver, double bulkModulus = kStiff) {
  return FluidScene(
      device, positions, velocities,
      object({{"spacing", kSpacing}, {"calibration", "lattice"}, {"bulk_modulus", bulkModulus}}),
      object({{"solver", object({{"params", std::move(solver)}})},
              {"viscosity", object({{"params", object({{"strength", 0.0}})}})}}));
}

void addTank(FluidScene& scene, const Value& parameters) {
  scene.graph().add(std::make_unique<StaticBoundary>(), "tank").assignAll(parameters, {"test", "", ""});
  scene.graph().link(SceneGraph::parseLink("tank.boundary -> water.boundaries"));
}

Value tolerantSolver(double tolerance) {
  return object({{"iterations", 1000}, {"tolerance", tolerance}, {"acceleration", "nesterov"}});
}

struct Hostile {
  const char* name;
  float jitter, speed;
  double dt, bulkModulus;
};

TEST(SolverMomentum, NeverEndsAboveTheObjectiveItBeganWith) {
  const Hostile cases[] = {{"long step", 0.2f, 0, 1e-2, 1e7},
                           {"longer and stiffer", 0.3f, 0, 5e-2, 1e9},
                           {"impacts", 0.2f, 3, 1e-2, 1e7},
                           {"disorder", 0.5f, 1, 5e-3, 1e7}};
  struct Energy {
    const char *name, *stepLength;
    std::vector<double> coefficients;
  };
  const Energy energies[] = {{"b0", "full", {1}},
                             {"b1", "particle", {0, 1}},
                             {"b1", "global", {0, 1}},
                             {"b2", "particle", {0, 0, 1}}};
  const auto device = openDevice("cpu");
  for (const Hostile& hostile : cases) {
    const std::vector<Vec3f> positions = jitteredCube(6, kSpacing, hostile.jitter, 5);
    const std::vector<Vec3f> velocities = randomVelocities(positions.size(), hostile.speed, 6);
    for (const Energy& energy : energies) {
      for (const int iterations : {2, 5, 20}) {
        Value solver = object({{"iterations", iterations},
                               {"acceleration", "nesterov"},
                               {"energy", energy.name},
                               {"step_length", energy.stepLength},
                               {"neighbor_searches", 2}});
        FluidScene scene = fluidWith(*device, positions, velocities, solver, hostile.bulkModulus);
        scene.gravity = {};
        scene.reset(hostile.dt);
        scene.step();
        ReferenceFluid reference{.spacing = kSpacing, .supportRatio = 1.5, .dt = hostile.dt};
        reference.mu = hostile.bulkModulus * reference.volume();
        reference.energy = energy.coefficients;
        std::vector<Vec3d> predicted = toDoubles(positions);
        for (std::size_t i = 0; i < predicted.size(); ++i)
          predicted[i] += hostile.dt * toDouble(velocities[i]);
        reference.positions = predicted;
        const double before = reference.objective(predicted);
        reference.positions = toDoubles(scene.positions());
        // What is no number is not less, either.
        EXPECT_LT(reference.objective(predicted), before)
            << hostile.name << ", " << energy.name << ", " << energy.stepLength << ", " << iterations;
      }
    }
  }
}

/// Kinetic energy, that of height, and that of compression, in J.
double energyOf(FluidScene& scene) {
  const NodeReport report = scene.report();
  const ParticleSet& particles = *scene.fluid().fluid->particles;
  double compression = 0;
  for (const float density : particles.get<float>("density").toHost(particles.bound())) {
    const double over = std::max(double(density) / 1000 - 1, 0.0);
    compression += 0.5 * over * over;
  }
  return report.statistics.find("kinetic_energy")->asDouble() +
         report.statistics.find("potential_energy")->asDouble() +
         kStiff * kSpacing * kSpacing * kSpacing * compression;
}

// With walls that act only after the solve, 10 ms steps compress this column by per cents.
TEST(SolverTolerance, IsMetOnAFloorInLongStepsAndEnergyFalls) {
  constexpr double kTolerance = 1e-3;
  std::vector<Vec3f> positions = jitteredCube(6, kSpacing, 0.02f, 3, {0.02f, 0.02f, 0.02f});
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    FluidScene scene = fluidWith(*device, positions, {}, tolerantSolver(kTolerance));
    addTank(scene, object({{"shape", "box"},
                           {"min", Value::Array{0, 0, 0}},
                           {"max", Value::Array{0.48, 0.6, 0.24}},
                           {"inverted", true}}));
    scene.reset(1e-2);
    double last = energyOf(scene), first = last, gained = 0;
    for (int step = 0; step < 100; ++step) {
      scene.step();
      const double now = energyOf(scene);
      gained += std::max(now - last, 0.0);
      last = now;
      EXPECT_LT(scene.report().statistics.find("compression")->find("mean")->asDouble(), 1.2 * kTolerance)
          << name << ", step " << step;
    }
    EXPECT_LT(last, first) << name;
    EXPECT_LT(gained, 0.02 * first) << name;
  }
}

TEST(SolverTolerance, SaysWhichStepsDidNotMeetIt) {
  // Particles a quarter of a spacing apart, and few iterations.
  std::vector<Vec3f> positions;
  for (int y = 0; y < 25; ++y) positions.push_back({0, (0.5f + float(y)) * 0.25f * kSpacing, 0});
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    Value solver = tolerantSolver(1e-4);
    solver["iterations"] = 5;
    solver["neighbor_searches"] = 3;
    FluidScene scene = fluidWith(*device, positions, {}, solver);
    scene.gravity = {};
    scene.reset(1e-3);
    scene.step();
    const NodeReport report = scene.report();
    EXPECT_EQ(*report.statistics.find("solver_iterations")->find("unmet"), Value(1)) << name;
    EXPECT_EQ(*report.statistics.find("solver_iterations")->find("last"), Value(15)) << name;
    bool told = false;
    for (const RareEvent& event : report.events)
      told = told || (event.count == 1 && event.what.find("tolerance") != std::string::npos);
    EXPECT_TRUE(told) << name;
  }
}

TEST(SolverTolerance, WallsBounceAndRubAsTheyDoWithout) {
  // A particle that falls on a floor obliquely, and one that slides on it.
  const std::vector<Vec3f> positions = {{0, 0.5f * kSpacing + 0.001f, 0}, {1, 0.5f * kSpacing, 0}};
  const std::vector<Vec3f> velocities = {{1, -2, 0}, {1, 0, 0}};
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    FluidScene scene = fluidWith(*device, positions, velocities, tolerantSolver(1e-3));
    addTank(scene, object({{"shape", "plane"}, {"restitution", 0.5}, {"friction", 0.25}}));
    constexpr double kDt = 1e-3;
    scene.reset(kDt);
    scene.step();
    const std::vector<Vec3f> v = scene.velocities();
    EXPECT_NEAR(v[0].y, 0.5 * (2 + 9.8 * kDt), 1e-4) << name;
    EXPECT_LT(v[0].x, 1) << name;
    EXPECT_NEAR(v[1].x, 1 - 0.25 * 9.8 * kDt, 1e-5) << name;
  }
}

// A plug that flies at the end of a channel by one and a half spacings a step, where it begins the step: it
// has nowhere to go. Without stages its layers pass each other and it goes on by 0.8 spacings.
TEST(SolverStages, FluidDoesNotPassItselfAtAWall) {
  constexpr int kLayers = 8;
  constexpr float kHalf = 0.5f * kSpacing;
  const float speed = 1.5f * kSpacing / 1e-2f;
  const std::vector<Vec3f> positions = jitteredCube(kLayers, kSpacing, 0.05f, 7, {kHalf, kHalf, kHalf});
  const std::vector<Vec3f> velocities(positions.size(), Vec3f{-speed, 0, 0});
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    FluidScene scene = fluidWith(*device, positions, velocities, tolerantSolver(1e-3), 1e8);
    const double width = kLayers * double(kSpacing);
    addTank(scene, object({{"shape", "box"},
                           {"min", Value::Array{0, 0, 0}},
                           {"max", Value::Array{4, width, width}},
                           {"inverted", true}}));
    scene.gravity = {};
    scene.reset(1e-2);
    scene.step();
    EXPECT_EQ(scene.report().statistics.find("solver_stages")->find("max")->asInt(), 2) << name;
    const std::vector<Vec3f> after = scene.positions();
    double way = 0;
    for (std::size_t i = 0; i < after.size(); ++i)
      way += double(positions[i].x - after[i].x) / double(after.size());
    EXPECT_LT(way, 0.5 * kSpacing) << name;
  }
}

TEST(SolverStages, ChangeNothingInFreeFlight) {
  constexpr double kDt = 1e-2;
  // Far from each other, slow and fast, the last by more than the most stages.
  const std::vector<Vec3f> positions = {{0, 0, 0}, {0, 10, 0}, {0, 20, 0}};
  for (const float fastest : {1.0f, 30.0f, 300.0f}) {
    const std::vector<Vec3f> velocities = {{0, 0, 1}, {3, 0, 0}, {fastest, -fastest, 0}};
    for (const std::string& name : availableDevices()) {
      const auto device = openDevice(name);
      FluidScene scene = fluidWith(*device, positions, velocities, tolerantSolver(1e-3));
      scene.gravity = {};
      scene.reset(kDt);
      scene.step(2);
      const std::vector<Vec3f> p = scene.positions(), v = scene.velocities();
      for (std::size_t i = 0; i < p.size(); ++i) {
        EXPECT_LT(length(p[i] - positions[i] - float(2 * kDt) * velocities[i]), 1e-5f) << name;
        EXPECT_LT(length(v[i] - velocities[i]), 1e-3f) << name;
      }
    }
  }
}

TEST(SolverTolerance, StepsReadNothingBackAndAllocateNothing) {
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    FluidScene scene = fluidWith(*device, jitteredCube(8, kSpacing, 0.2f, 5), {}, tolerantSolver(1e-3));
    scene.reset(1e-2);
    scene.step(3);
    const std::uint64_t allocations = device->memoryUse().allocations;
    const std::uint64_t readbacks = device->blockingReadbacks();
    scene.step(10);
    EXPECT_EQ(device->memoryUse().allocations, allocations) << name;
    EXPECT_EQ(device->blockingReadbacks(), readbacks) << name;
  }
}

}  // namespace
}  // namespace weir::test
