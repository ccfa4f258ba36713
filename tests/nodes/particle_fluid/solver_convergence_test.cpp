// Tolerance, acceleration, walls and repeated searches of the solver where they are hard: long steps, stiff
// fluid, impacts.
#include <gtest/gtest.h>

#include <cmath>

#include "nodes/static_boundary/static_boundary.h"
#include "tests/nodes/particle_fluid/modules/module_test_support.h"
#include "tests/nodes/semi_analytical_sfi/solid_scene.h"
#include "tests/support/meshes.h"

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
      object({{"solver", object({{"type", "AcceleratedSolver"}, {"params", std::move(solver)}})},
              {"viscosity", object({{"params", object({{"rate", 0.0}})}})}}));
}

void addTank(FluidScene& scene, const Value& parameters) {
  scene.graph().add(std::make_unique<StaticBoundary>(), "tank").assignAll(parameters, {"test", "", ""});
  scene.graph().link(SceneGraph::parseLink("tank.boundary -> water.boundaries"));
}

Value tolerantSolver(double tolerance, const std::string& acceleration = "conjugate") {
  return object({{"max_iterations", 1000}, {"tolerance", tolerance}, {"acceleration", acceleration}});
}

/// Of each kind that there is.
class SolverAcceleration : public testing::TestWithParam<std::string> {};

struct Hostile {
  const char* name;
  float jitter, speed;
  double dt, bulkModulus;
};

/// The largest distance of a particle from itself.
double farthest(const std::vector<Vec3f>& a, const std::vector<Vec3f>& b) {
  double max = 0;
  for (std::size_t i = 0; i < a.size(); ++i) max = std::max(max, double(length(a[i] - b[i])));
  return max;
}

TEST_P(SolverAcceleration, NeverEndsAboveTheObjectiveItBeganWith) {
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
        Value solver = object({{"max_iterations", iterations},
                               {"tolerance", Value()},
                               {"acceleration", GetParam()},
                               {"energy", energy.name},
                               // Conjugate gradients search it themselves.
                               {"step_length", GetParam() == "conjugate" ? "full" : energy.stepLength},
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
        // NaN is not less, either.
        EXPECT_LT(reference.objective(predicted), before)
            << hostile.name << ", " << energy.name << ", " << energy.stepLength << ", " << iterations;
      }
    }
  }
}

/// A compressed block in the corner of a tank.
struct FallingBlock {
  FallingBlock(Device& device, Value solver) : scene(fluidWith(device, start, {}, std::move(solver))) {
    addTank(scene, object({{"shape", "box"},
                           {"min", Value::Array{0, 0, 0}},
                           {"max", Value::Array{0.48, 0.6, 0.24}},
                           {"inverted", true}}));
  }
  std::vector<Vec3f> start =
      jitteredCube(6, 0.95f * kSpacing, 0.1f, 3, {0.5f * kSpacing, 0.5f * kSpacing, 0.5f * kSpacing});
  FluidScene scene;
};

// Every particle must be where it is without acceleration, and stay there: nothing changes any more.
TEST_P(SolverAcceleration, LeadsToWherePlainIterationsLead) {
  constexpr int kPlain = 8000;
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    std::vector<Vec3f> start;
    const auto after = [&](int iterations, bool accelerated) {
      Value solver = object({{"max_iterations", iterations}, {"neighbor_searches", 1}});
      solver["acceleration"] = accelerated ? GetParam() : std::string("none");
      // Walls take part in iterations that are accelerated or end by a tolerance; this one is never met.
      solver["tolerance"] = accelerated ? Value() : Value(1e-6);
      FallingBlock block(*device, solver);
      block.scene.reset(5e-3);
      block.scene.step();
      start = block.start;
      return block.scene.positions();
    };
    const std::vector<Vec3f> plain = after(kPlain, false);
    EXPECT_GT(farthest(plain, start), 0.1 * kSpacing) << name;
    for (const int iterations : {500, 1000, 2000}) {
      const double apart = farthest(after(iterations, true), plain);
      std::printf("from %d plain iterations on %s: %.1e m after %d with %s\n", kPlain, name.c_str(), apart,
                  iterations, GetParam().c_str());
      EXPECT_LT(apart, 1e-3 * kSpacing) << name << ", " << iterations;
    }
  }
}

// Where all has converged, what iterations go by is noise, and the next step must not be the worse for it.
TEST_P(SolverAcceleration, IterationsBeyondConvergenceChangeNothing) {
  const auto device = openDevice("cpu");
  const auto after = [&](int iterations) {
    FallingBlock block(*device, object({{"max_iterations", iterations},
                                        {"tolerance", Value()},
                                        {"acceleration", GetParam()},
                                        {"neighbor_searches", 1}}));
    block.scene.reset(2e-3);
    block.scene.step(10);
    return block.scene.positions();
  };
  EXPECT_LT(farthest(after(400), after(800)), 1e-2 * kSpacing);
}

TEST_P(SolverAcceleration, NeedsFewerIterations) {
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    std::int64_t iterations[2] = {};
    for (const bool accelerated : {false, true}) {
      // The walls carry it with 0.14 %.
      FallingBlock block(*device, tolerantSolver(2e-3, accelerated ? GetParam() : "none"));
      block.scene.reset(1e-2);
      block.scene.step();
      const Value used = *block.scene.report().statistics.find("solver_iterations");
      EXPECT_EQ(*used.find("not_converged"), Value(0)) << name;
      iterations[accelerated] = used.find("last")->asInt();
    }
    std::printf("iterations of a fall on %s: %d plain, %d with %s\n", name.c_str(), int(iterations[0]),
                int(iterations[1]), GetParam().c_str());
    EXPECT_LT(2 * iterations[1], iterations[0]) << name;
  }
}

// Pairs push each other alike once the iterations have converged: what the fluid gains is what the ground
// lost, by the walls' part of the displacement.
TEST_P(SolverAcceleration, FollowsTheForceOfMeshes) {
  constexpr double kDt = 2e-3;
  const std::vector<Vec3f> positions =
      jitteredCube(6, 0.95f * kSpacing, 0.1f, 7, {-0.1f, 0.35f * kSpacing, -0.1f});
  const std::vector<Vec3f> velocities(positions.size(), Vec3f{0, -1, 0});
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    SolidScene scene(*device, positions, velocities,
                     object({{"spacing", kSpacing}, {"calibration", "lattice"}, {"bulk_modulus", 1e6}}),
                     object({{"solver", object({{"type", "AcceleratedSolver"},
                                                {"params", object({{"tolerance", Value()},
                                                                   {"max_iterations", 200},
                                                                   {"acceleration", GetParam()}})}})},
                             {"viscosity", object({{"enabled", false}})}}));
    scene.gravity = {};
    SemiAnalyticalSFI& contact = scene.couple({boxMesh({-2, -1, -2}, {2, 0, 2})});
    scene.reset(kDt);
    scene.step();
    const double mass = 1000 * std::pow(double(kSpacing), 3);
    const Vec3d gained = mass * (sumOf(scene.velocities()) - sumOf(velocities));
    scene.frame();
    const Vec3d impulse = kDt * contact.forces->solids.front().force;
    EXPECT_GT(gained.y, 0.01 * mass * double(positions.size())) << name;
    EXPECT_NEAR(impulse.y, -gained.y, 1e-3 * gained.y) << name;
  }
}

TEST_P(SolverAcceleration, CpuIsBitwiseTheSameForAnyNumberOfThreads) {
  const std::vector<Vec3f> positions = jitteredCube(17, kSpacing, 0.2f, 5);  // more than a block of a sum
  const std::vector<Vec3f> velocities = randomVelocities(positions.size(), 1.0f, 6);
  std::vector<Vec3f> expected;
  for (const int threads : {1, 2, 3, 4}) {
    CpuDevice device(threads);
    FluidScene scene = fluidWith(device, positions, velocities, tolerantSolver(1e-3, GetParam()));
    scene.reset(1e-2);
    for (int frame = 0; frame < 2; ++frame) scene.step(2), scene.frame();
    if (expected.empty()) expected = scene.positions();
    EXPECT_EQ(scene.positions(), expected) << threads << " threads";
  }
}

TEST_P(SolverAcceleration, StepsReadNothingBackAndAllocateNothing) {
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    FluidScene scene =
        fluidWith(*device, jitteredCube(8, kSpacing, 0.2f, 5), {}, tolerantSolver(1e-3, GetParam()));
    scene.reset(1e-2);
    scene.step(3);
    const std::uint64_t allocations = device->memoryUse().allocations;
    const std::uint64_t readbacks = device->blockingReadbacks();
    scene.step(10);
    EXPECT_EQ(device->memoryUse().allocations, allocations) << name;
    EXPECT_EQ(device->blockingReadbacks(), readbacks) << name;
  }
}

/// Kinetic energy, that of height, and that of compression, in J.
double energyOf(FluidScene& scene) {
  const NodeReport report = scene.report();
  const ParticleSet& particles = scene.fluid().fluid->set();
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
TEST_P(SolverAcceleration, MeetsToleranceOnAFloorInLongStepsAndEnergyFalls) {
  constexpr double kTolerance = 1e-3;
  std::vector<Vec3f> positions = jitteredCube(6, kSpacing, 0.02f, 3, {0.02f, 0.02f, 0.02f});
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    FluidScene scene = fluidWith(*device, positions, {}, tolerantSolver(kTolerance, GetParam()));
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
    std::printf("energy gained in a collapse on %s: %.2f %% with %s, %.1f iterations a step\n", name.c_str(),
                100 * gained / first, GetParam().c_str(),
                scene.report().statistics.find("solver_iterations")->find("mean")->asDouble());
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
    solver["max_iterations"] = 5;
    solver["neighbor_searches"] = 3;
    FluidScene scene = fluidWith(*device, positions, {}, solver);
    scene.gravity = {};
    scene.reset(1e-3);
    scene.step();
    const NodeReport report = scene.report();
    EXPECT_EQ(*report.statistics.find("solver_iterations")->find("not_converged"), Value(1)) << name;
    EXPECT_EQ(*report.statistics.find("solver_iterations")->find("last"), Value(15)) << name;
    bool told = false;
    for (const RareEvent& event : report.events)
      told = told || (event.count == 1 && event.what.find("tolerance") != std::string::npos);
    EXPECT_TRUE(told) << name;
  }
}

TEST(SolverTolerance, WallsBounceAndRubAsTheyDoWithout) {
  // A particle that falls on a floor obliquely, and one that slides on it.
  constexpr float kContact = kContactRatio * kSpacing;
  const std::vector<Vec3f> positions = {{0, kContact + 0.001f, 0}, {1, kContact, 0}};
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

using SolverStages = SolverAcceleration;

/// How far a plug gets on average, in spacings, that flies at the end of a channel by one and a half spacings
/// a step, where it begins the step: it has nowhere to go.
double wayAtAWall(const std::string& deviceName, const std::string& acceleration, unsigned seed) {
  constexpr int kLayers = 8;
  constexpr float kHalf = 0.5f * kSpacing;
  const float speed = 1.5f * kSpacing / 1e-2f;
  const std::vector<Vec3f> positions = jitteredCube(kLayers, kSpacing, 0.05f, seed, {kHalf, kHalf, kHalf});
  const std::vector<Vec3f> velocities(positions.size(), Vec3f{-speed, 0, 0});
  const auto device = openDevice(deviceName);
  FluidScene scene = fluidWith(*device, positions, velocities, tolerantSolver(1e-3, acceleration), 1e8);
  const double width = kLayers * double(kSpacing);
  addTank(scene, object({{"shape", "box"},
                         {"min", Value::Array{0, 0, 0}},
                         {"max", Value::Array{4, width, width}},
                         {"inverted", true}}));
  scene.gravity = {};
  scene.reset(1e-2);
  scene.step();
  EXPECT_EQ(scene.report().statistics.find("solver_stages")->find("max")->asInt(), 2) << deviceName;
  const std::vector<Vec3f> after = scene.positions();
  double way = 0;
  for (std::size_t i = 0; i < after.size(); ++i)
    way += double(positions[i].x - after[i].x) / double(after.size());
  return way / kSpacing;
}

// Without stages its layers pass each other and it goes on by 0.8 spacings. With momentum a single start may
// get half of that or more, depending on the last bits.
TEST_P(SolverStages, FluidDoesNotPassItselfAtAWall) {
  constexpr unsigned kStarts = 4;
  for (const std::string& name : availableDevices()) {
    double mean = 0;
    for (unsigned seed = 7; seed < 7 + kStarts; ++seed) mean += wayAtAWall(name, GetParam(), seed) / kStarts;
    EXPECT_LT(mean, 0.5) << name;
  }
}

TEST_P(SolverStages, ChangeNothingInFreeFlight) {
  constexpr double kDt = 1e-2;
  // Far from each other, slow and fast, the last by more than the most stages.
  const std::vector<Vec3f> positions = {{0, 0, 0}, {0, 10, 0}, {0, 20, 0}};
  for (const float fastest : {1.0f, 30.0f, 300.0f}) {
    const std::vector<Vec3f> velocities = {{0, 0, 1}, {3, 0, 0}, {fastest, -fastest, 0}};
    for (const std::string& name : availableDevices()) {
      const auto device = openDevice(name);
      FluidScene scene = fluidWith(*device, positions, velocities, tolerantSolver(1e-3, GetParam()));
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

// 16 stages ask for three iterations each.
TEST_P(SolverStages, AStepThatHasHadItsIterationsStillGoesAllTheWay) {
  constexpr double kDt = 1e-2;
  const Vec3f velocity{0, 0, 100};
  const std::vector<Vec3f> positions = jitteredCube(6, 0.9f * kSpacing, 0.1f, 5);
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    Value solver = tolerantSolver(1e-6, GetParam());
    solver["max_iterations"] = 5;
    FluidScene scene = fluidWith(*device, positions, std::vector<Vec3f>(positions.size(), velocity), solver);
    scene.gravity = {};
    scene.reset(kDt);
    scene.step();
    const NodeReport report = scene.report();
    EXPECT_LE(report.statistics.find("solver_iterations")->find("max")->asInt(), 6) << name;
    EXPECT_EQ(*report.statistics.find("solver_iterations")->find("not_converged"), Value(1)) << name;
    EXPECT_EQ(*report.statistics.find("solver_stages")->find("max"), Value(16)) << name;
    const double count = double(positions.size());
    const Vec3d way = sumOf(scene.positions()) - sumOf(positions);
    EXPECT_NEAR(way.z / count, kDt * velocity.z, 1e-4) << name;
    EXPECT_NEAR(way.x / count, 0, 1e-5) << name;
  }
}

const auto kAccelerations = testing::Values("nesterov", "conjugate");
const auto kByName = [](const auto& tested) { return tested.param; };
INSTANTIATE_TEST_SUITE_P(, SolverAcceleration, kAccelerations, kByName);
INSTANTIATE_TEST_SUITE_P(, SolverStages, kAccelerations, kByName);

}  // namespace
}  // namespace weir::test
