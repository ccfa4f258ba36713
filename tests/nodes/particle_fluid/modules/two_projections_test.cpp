// What the operator of TwoProjections is exact for, and what a projection keeps.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "framework/compute/cpu_threads.h"
#include "framework/particles/relaxed_tile.h"
#include "nodes/particle_fluid/particle_fluid.h"
#include "nodes/semi_analytical_sfi/semi_analytical_sfi.h"
#include "nodes/static_boundary/static_boundary.h"
#include "tests/nodes/particle_fluid/modules/module_test_support.h"
#include "tests/support/expect_error.h"
#include "tests/support/simulated_scene.h"

namespace weir::test {
namespace {

constexpr float kSpacing = 0.02f;
constexpr int kSide = 12;

Value twoProjections(double smoothing) {
  return object(
      {{"solver", object({{"type", "TwoProjections"}, {"params", object({{"smoothing", smoothing}})}})},
       {"viscosity", disabled()}});
}

/// Without gravity.
struct ProjectedFluid : FluidScene {
  ProjectedFluid(Device& device, const std::vector<Vec3f>& positions, const std::vector<Vec3f>& velocities,
                 double smoothing)
      : FluidScene(device, positions, velocities, object({{"spacing", kSpacing}, {"support_ratio", 2.0}}),
                   twoProjections(smoothing)) {
    gravity = {};
  }
};

std::vector<Vec3f> afterOneStep(Device& device, const std::vector<Vec3f>& positions,
                                const std::vector<Vec3f>& velocities, double smoothing) {
  ProjectedFluid scene(device, positions, velocities, smoothing);
  scene.reset(1e-3);
  scene.step();
  return scene.velocities();
}

double rootOfMeanSquare(const std::vector<Vec3f>& velocities, const Vec3f& relativeTo = {}) {
  double squares = 0;
  for (const Vec3f& v : velocities) squares += dot(v - relativeTo, v - relativeTo);
  return std::sqrt(squares / double(velocities.size()));
}

/// Disordered fluid at rest: what is compressed would have to expand, and what is not balanced gets a kick
/// from any pressure. With the origin between its nodes.
std::vector<Vec3f> relaxedCube(int side) {
  CpuThreads threads(1);
  const RelaxedTile tile(2, kSide, 300, 1, threads);
  std::vector<Vec3f> positions;
  for (int x = 0; x < side; ++x)
    for (int y = 0; y < side; ++y)
      for (int z = 0; z < side; ++z)
        positions.push_back(kSpacing * (Vec3f{x + 0.5f, y + 0.5f, z + 0.5f} -
                                        0.5f * float(side) * Vec3f{1, 1, 1} + tile.displacement(x, y, z)));
  return positions;
}

/// Whether particles are around it on all sides, those with which it shares a gradient too.
bool isInside(const Vec3f& p) {
  constexpr float kMost = (0.5f * kSide - 3.5f) * kSpacing;
  return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) < kMost;
}

TEST(TwoProjections, LeavesLinearVelocitiesWithoutDivergenceAlone) {
  std::vector<Vec3f> positions = relaxedCube(kSide), velocities;
  for (Vec3f& p : positions) {
    p = 1.005f * p;  // so that nothing is compressed, and has to expand
    // Stretch, shear and rotation, far faster than this little below rest density may close up.
    velocities.push_back(10 * Vec3f{1 + 5 * p.x + 8 * p.y, -2 * p.y + 3 * p.z - 4 * p.x, -3 * p.z + 6 * p.x});
  }
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    const std::vector<Vec3f> after = afterOneStep(*device, positions, velocities, 0.3);
    int inside = 0;
    for (std::size_t i = 0; i < positions.size(); ++i) {
      if (!isInside(positions[i])) continue;
      ++inside;
      EXPECT_LT(length(after[i] - velocities[i]), 1e-4f) << name;
    }
    EXPECT_GT(inside, 50);
  }
}

/// With a floor and a wall that they slip along. What walls leave out of the gradients would be smoothed
/// away.
TEST(TwoProjections, LeavesLinearVelocitiesAlongWallsAlone) {
  std::vector<Vec3f> positions = relaxedCube(kSide), velocities;
  const Vec3f corner = -0.5f * kSide * kSpacing * Vec3f{1, 1, 1};
  for (Vec3f& p : positions) {
    Vec3f from = 1.06f * (p - corner);
    from.x = std::max(from.x, 0.3f * kSpacing), from.y = std::max(from.y, 0.3f * kSpacing);
    p = corner + from;
    velocities.push_back({3 * from.x, 4 * from.y, 2 * from.z + 5 * p.z});
  }
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    ProjectedFluid scene(*device, positions, velocities, 1);
    const Value low = Value::Array{corner.x, corner.y, -1}, high = Value::Array{1, 1, 1};
    scene.graph()
        .add(std::make_unique<StaticBoundary>(), "tank")
        .assignAll(object({{"shape", "box"}, {"min", low}, {"max", high}, {"inverted", true}}),
                   {"test", "", ""});
    scene.graph().link(SceneGraph::parseLink("tank.boundary -> water.boundaries"));
    scene.reset(1e-3);
    scene.step();
    const std::vector<Vec3f> after = scene.velocities();
    int near = 0;
    constexpr float kMost = (0.5f * kSide - 3.5f) * kSpacing;
    for (std::size_t i = 0; i < positions.size(); ++i) {
      const Vec3f p = positions[i];
      if (p.x > kMost || p.y > kMost || std::abs(p.z) > kMost) continue;
      if (std::min(p.x, p.y) - corner.x < kSpacing) ++near;
      EXPECT_LT(length(after[i] - velocities[i]), 1e-4f) << name << " " << p.x << " " << p.y << " " << p.z;
    }
    EXPECT_GT(near, 50);
  }
}

TEST(TwoProjections, KeepsMomentumAndTakesKineticEnergyAway) {
  const std::vector<Vec3f> positions = relaxedCube(kSide);
  const std::vector<Vec3f> velocities = randomVelocities(positions.size(), 0.5f, 6);
  const auto energyOf = [](const std::vector<Vec3f>& of) {
    double sum = 0;
    for (const Vec3f& v : of) sum += dot(toDouble(v), toDouble(v)) / 2;
    return sum;
  };
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    const std::vector<Vec3f> after = afterOneStep(*device, positions, velocities, 0);
    EXPECT_LT(length(sumOf(after) - sumOf(velocities)), 1e-5 * std::sqrt(energyOf(velocities))) << name;
    EXPECT_LT(energyOf(after), 0.95 * energyOf(velocities)) << name;
    // What a projection takes away is normal to what it leaves.
    double along = 0;
    for (std::size_t i = 0; i < after.size(); ++i)
      along += dot(toDouble(after[i]), toDouble(velocities[i]) - toDouble(after[i]));
    EXPECT_LT(std::abs(along), 2e-2 * energyOf(velocities)) << name;
  }
}

/// A ball that falls into itself is stopped: −k·x is the gradient of the pressure −k·(R² − r²)/2.
TEST(TwoProjections, StopsABallThatFallsIntoItself) {
  constexpr float kRadius = 9 * kSpacing, kRate = 50;
  std::vector<Vec3f> positions, velocities;
  for (const Vec3f& p : relaxedCube(18))
    if (length(p) < kRadius) positions.push_back(p), velocities.push_back(-kRate * p);
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    const std::vector<Vec3f> after = afterOneStep(*device, positions, velocities, 0);
    double before = 0, along = 0, left = 0;
    for (std::size_t i = 0; i < positions.size(); ++i) {
      if (length(positions[i]) > 0.7f * kRadius) continue;
      before += dot(toDouble(velocities[i]), toDouble(velocities[i]));
      along += dot(toDouble(velocities[i]), toDouble(after[i]));
      left += dot(toDouble(after[i]), toDouble(after[i]));
    }
    EXPECT_LT(std::abs(along / before), 0.05) << name;
    EXPECT_LT(std::sqrt(left / before), 0.15) << name;
  }
}

TEST(TwoProjections, PartsParticlesInOnePlace) {
  std::vector<Vec3f> positions = jitteredCube(kSide, kSpacing, 0, 3);
  positions.push_back(positions[positions.size() / 2 + kSide / 2]);
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    ProjectedFluid scene(*device, positions, std::vector<Vec3f>(positions.size()), 0.3);
    scene.reset(1e-3);
    for (int k = 0; k < 50; ++k) scene.step();
    const std::vector<Vec3f> after = scene.positions();
    float nearest = kSpacing;
    for (std::size_t i = 0; i < after.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) nearest = std::min(nearest, length(after[i] - after[j]));
    EXPECT_GT(nearest, 0.3f * kSpacing) << name;
  }
}

TEST(TwoProjections, CpuIsBitwiseTheSameForAnyNumberOfThreadsAndAllItsInstructions) {
  const std::vector<Vec3f> positions = relaxedCube(kSide),
                           velocities = randomVelocities(positions.size(), 0.5f, 6);
  const auto after = [&](int threads, CpuIsa isa) {
    CpuDevice device(threads, isa);
    ProjectedFluid scene(device, positions, velocities, 0.3);
    scene.reset(1e-3);
    scene.step(3);
    return scene.positions();
  };
  const std::vector<Vec3f> expected = after(1, usableCpuIsas().front());
  for (const int threads : {2, 3})
    for (const CpuIsa isa : usableCpuIsas()) EXPECT_EQ(after(threads, isa), expected) << threads;
}

std::vector<Vec3f> afterTheRun(SimulatedScene& scene, std::vector<Vec3f>* positions = nullptr) {
  scene->reset();
  const std::atomic<bool> never = false;
  while (scene->advanceFrame(never)) {
  }
  const ParticleSet& particles = scene.node<ParticleFluid>("water").fluid->set();
  if (positions != nullptr) *positions = particles.positions().toHost(particles.bound());
  return particles.velocities().toHost(particles.bound());
}

const char* const kWaterInABox = R"({
  "weir": 1, "world": {"dt": 0.002, "frame_rate": 5, "duration": 0.4},
  "nodes": {
    "block": {"type": "BoxSampler", "params": {"min": [0, 0, 0], "max": [0.2, 0.2, 0.2]}},
    "tank": {"type": "StaticBoundary", "params": {"shape": "box", "min": [0, 0, 0], "max": [0.2, 1, 0.2],
                                                  "inverted": true, "report_forces": true}},
    "water": {"type": "ParticleFluid", "params": {"spacing": 0.025},
              "modules": {"viscosity": {"enabled": false}, "solver": {"type": "TwoProjections"}}}
  },
  "links": ["block.particles -> water.initial", "tank.boundary -> water.boundaries"]})";

/// The volume of water at rest, its calm, and its weight on the floor.
TEST(TwoProjections, WaterInABoxRests) {
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    SimulatedScene scene(*device, kWaterInABox);
    std::vector<Vec3f> positions;
    const std::vector<Vec3f> velocities = afterTheRun(scene, &positions);
    double height = 0;
    for (const Vec3f& p : positions) height += p.y / double(positions.size());
    EXPECT_EQ(positions.size(), 512u) << name;
    EXPECT_NEAR(height, 0.1, 0.001) << name;
    EXPECT_LT(rootOfMeanSquare(velocities), 0.06) << name;
    NodeReport report;
    scene.node<StaticBoundary>("tank").report(report);
    const double weight = 1000 * 0.2 * 0.2 * 0.2 * 9.8;
    EXPECT_NEAR(report.statistics["force"].asArray()[1].asDouble(), -weight, 0.05 * weight) << name;
  }
}

TEST(TwoProjections, WallsAreBitwiseTheSameForAllInstructionsOfTheCpu) {
  std::vector<Vec3f> expected;
  for (const CpuIsa isa : usableCpuIsas()) {
    CpuDevice device(1, isa);
    SimulatedScene scene(device, kWaterInABox);
    scene->reset();
    const std::atomic<bool> never = false;
    ASSERT_TRUE(scene->advanceFrame(never));
    const ParticleSet& particles = scene.node<ParticleFluid>("water").fluid->set();
    const std::vector<Vec3f> positions = particles.positions().toHost(particles.bound());
    if (expected.empty()) expected = positions;
    EXPECT_EQ(positions, expected);
  }
}

/// Archimedes: a cube of five spacings that is held is lifted by the weight of the water that it displaces.
/// Where walls push by the pressure at particles, it is lifted by more.
TEST(TwoProjections, AHeldCubeIsLiftedByTheWeightOfItsWater) {
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    SimulatedScene scene(*device, R"({
      "weir": 1, "world": {"dt": 0.002, "frame_rate": 10, "duration": 0.4},
      "nodes": {
        "block": {"type": "BoxSampler", "params": {"min": [0, 0, 0], "max": [0.24, 0.24, 0.24]}},
        "tank": {"type": "StaticBoundary", "params": {"shape": "box", "min": [0, 0, 0], "max": [0.24, 0.5, 0.24], "inverted": true}},
        "cube": {"type": "BoxMesh", "params": {"min": [0.07, 0.07, 0.07], "max": [0.17, 0.17, 0.17]}},
        "held": {"type": "SemiAnalyticalSFI"},
        "water": {"type": "ParticleFluid", "params": {"spacing": 0.02, "rest_steps": 300},
                  "modules": {"viscosity": {"enabled": false}, "solver": {"type": "TwoProjections"}}}
      },
      "links": ["block.particles -> water.initial", "tank.boundary -> water.boundaries",
                "cube.surface -> held.solids", "water.fluid -> held.fluid"]})");
    scene->reset();
    const std::atomic<bool> never = false;
    double lift = 0;
    int frames = 0;
    while (scene->advanceFrame(never)) {
      NodeReport report;
      scene.node<SemiAnalyticalSFI>("held").report(report);
      const double force =
          report.statistics["solids"].asArray().front().find("force")->asArray()[1].asDouble();
      if (++frames > 2) lift += force / 2;
    }
    const double weight = 1000 * 0.1 * 0.1 * 0.1 * 9.8;
    std::printf("%s: lift over the weight of the water %.3f\n", name.c_str(), lift / weight);
    EXPECT_NEAR(lift / weight, 1, 0.05) << name;
  }
}

/// Walls at rest would stop the water.
TEST(TwoProjections, WaterInATankThatMovesIsCarriedAlong) {
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    SimulatedScene scene(*device, R"({
      "weir": 1, "world": {"dt": 0.002, "frame_rate": 10, "duration": 0.1},
      "nodes": {
        "block": {"type": "BoxSampler", "params": {"min": [0, 0, 0], "max": [0.15, 0.15, 0.15], "velocity": [1, 0, 0.5]}},
        "box": {"type": "BoxMesh", "params": {"min": [0, 0, 0], "max": [0.15, 1, 0.15]}},
        "tank": {"type": "SemiAnalyticalSFI", "params": {"fill": "container", "velocity": [1, 0, 0.5]}},
        "water": {"type": "ParticleFluid", "params": {"spacing": 0.025},
                  "modules": {"viscosity": {"enabled": false}, "solver": {"type": "TwoProjections"}}}
      },
      "links": ["block.particles -> water.initial", "box.surface -> tank.solids", "water.fluid -> tank.fluid"]})");
    EXPECT_LT(rootOfMeanSquare(afterTheRun(scene), {1, 0, 0.5f}), 0.1) << name;
  }
}

TEST(TwoProjections, WarnsOfASupportThatIsTooSmall) {
  CpuDevice device(1);
  for (const double ratio : {1.5, 2.0}) {
    FluidScene scene(device, relaxedCube(2), std::vector<Vec3f>(8),
                     object({{"spacing", kSpacing}, {"support_ratio", ratio}}), twoProjections(1));
    scene.reset(1e-3);
    EXPECT_EQ(scene.warnings().size(), ratio < 1.8 ? 1u : 0u) << ratio;
    for (const std::string& warning : scene.warnings())
      EXPECT_CONTAINS(warning, "better: a support_ratio of 2");
  }
}

}  // namespace
}  // namespace weir::test
