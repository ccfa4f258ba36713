// The semi-implicit solver against a double-precision reference, conservation laws, and itself.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/nodes/particle_fluid/modules/module_test_support.h"

namespace weir::test {
namespace {

struct OneStepCase {
  float spacing, supportRatio;
  double dt;
  bool conservative;
};

class OneStep : public testing::TestWithParam<OneStepCase> {};

TEST_P(OneStep, AgreesWithDoublePrecision) {
  const OneStepCase& c = GetParam();
  const std::vector<Vec3f> positions = jitteredCube(14, c.spacing, 0.2f, 7, {0.1f, 0.2f, -0.05f});
  const std::vector<Vec3f> velocities = randomVelocities(positions.size(), 0.5f, 8);
  ReferenceFluid reference{.spacing = c.spacing,
                           .supportRatio = c.supportRatio,
                           .dt = c.dt,
                           .conservative = c.conservative,
                           .xsph = 0.3};
  for (const Vec3f& p : positions) reference.positions.push_back(toDouble(p));
  for (const Vec3f& v : velocities) reference.velocities.push_back(toDouble(v));
  reference.step();

  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    FluidScene scene(
        *device, positions, velocities,
        object({{"spacing", c.spacing},
                {"support_ratio", c.supportRatio},
                {"calibration", "lattice"},
                {"mu", 1.0}}),
        object(
            {{"solver", object({{"params", object({{"iterations", 3}, {"conservative", c.conservative}})}})},
             {"viscosity", object({{"params", object({{"form", "explicit"}, {"strength", 0.3}})}})}}));
    scene.reset(c.dt);
    scene.step();
    EXPECT_LT(largestDifference(scene.positions(), reference.positions) / c.spacing, 1e-4) << name;
    // A velocity error of 1e-4 spacings a step.
    EXPECT_LT(largestDifference(scene.velocities(), reference.velocities) * c.dt / c.spacing, 1e-4) << name;
    EXPECT_EQ(scene.report().statistics["neighbors_truncated"], Value(0)) << name;
  }
}

std::vector<OneStepCase> oneStepCases() {
  std::vector<OneStepCase> cases;
  for (const float spacing : {0.005f, 0.01f, 0.02f, 0.04f})
    for (const float ratio : {1.2f, 1.5f, 2.0f})
      for (const double dt : {1e-3, 5e-3}) cases.push_back({spacing, ratio, dt, true});
  cases.push_back({0.01f, 1.5f, 1e-3, false});
  cases.push_back({0.02f, 1.2f, 2e-3, false});
  return cases;
}

INSTANTIATE_TEST_SUITE_P(Settings, OneStep, testing::ValuesIn(oneStepCases()));

TEST(SemiImplicitSolver, DensityAgreesWithDoublePrecision) {
  const std::vector<Vec3f> positions = jitteredCube(10, 0.01f, 0.3f, 3);
  ReferenceFluid reference{.spacing = 0.01, .supportRatio = 1.5};
  for (const Vec3f& p : positions) reference.positions.push_back(toDouble(p));
  const std::vector<double> expected = reference.relativeDensities();
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    FluidScene scene(*device, positions, {}, object({{"calibration", "lattice"}}));
    scene.reset(1e-3);
    const ParticleSet& particles = scene.fluid().fluid->set();
    const std::vector<float> densities = particles.get<float>("density").toHost(particles.bound());
    const std::vector<std::int64_t> ids = particles.ids().toHost(particles.bound());
    for (std::size_t k = 0; k < ids.size(); ++k)
      EXPECT_NEAR(densities[k] / 1000, expected[static_cast<std::size_t>(ids[k])], 2e-5) << name;
  }
}

TEST(SemiImplicitSolver, CpuIsBitwiseTheSameForAnyNumberOfThreads) {
  const std::vector<Vec3f> positions = jitteredCube(16, 0.01f, 0.2f, 5);
  const std::vector<Vec3f> velocities = randomVelocities(positions.size(), 1.0f, 6);
  std::vector<Vec3f> expected;
  for (const int threads : {1, 2, 3, 4}) {
    CpuDevice device(threads);
    FluidScene scene(device, positions, velocities, object({}));
    scene.reset(1e-3);
    for (int frame = 0; frame < 5; ++frame) scene.step(20), scene.frame();
    if (expected.empty()) expected = scene.positions();
    EXPECT_EQ(scene.positions(), expected) << threads << " threads";
  }
}

TEST(SemiImplicitSolver, CudaRepeatsBitwise) {
  for (const std::string& name : availableDevices()) {
    const std::vector<Vec3f> positions = jitteredCube(16, 0.01f, 0.2f, 5);
    std::vector<Vec3f> first;
    for (int run = 0; run < 2; ++run) {
      const auto device = openDevice(name);
      FluidScene scene(*device, positions, {}, object({}));
      scene.reset(1e-3);
      scene.step(100);
      if (run == 0) first = scene.positions();
      EXPECT_EQ(scene.positions(), first) << name;
    }
  }
}

TEST(SemiImplicitSolver, StepsAllocateNothingAndReadNothingBack) {
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    FluidScene scene(*device, jitteredCube(12, 0.01f, 0.2f, 5), {}, object({}));
    scene.reset(1e-3);
    scene.step(3);
    const std::uint64_t allocations = device->memoryUse().allocations;
    const std::uint64_t readbacks = device->blockingReadbacks();
    scene.step(50);
    EXPECT_EQ(device->memoryUse().allocations, allocations) << name;
    EXPECT_EQ(device->blockingReadbacks(), readbacks) << name;
  }
}

/// Drift of the linear momentum of a ball of fluid that flies and spins without gravity, as a part of the sum
/// of its particles' momenta, over 1,000 steps.
double momentumDrift(Device& device, float jitter, int iterations) {
  constexpr float kSpacing = 0.01f, kRadius = 0.08f, kSpin = 5;  // m, m, 1/s
  std::vector<Vec3f> positions, velocities;
  for (const Vec3f& p : jitteredCube(18, kSpacing, jitter, 11, {-0.085f, -0.085f, -0.085f})) {
    if (length(p) > kRadius) continue;
    positions.push_back(p);
    velocities.push_back(cross(Vec3f{0, kSpin, 0}, p) + Vec3f{0.3f, 0.1f, 0});
  }
  FluidScene scene(device, positions, velocities, object({{"spacing", kSpacing}}),
                   object({{"solver", object({{"params", object({{"iterations", iterations}})}})}}));
  scene.gravity = {};
  scene.reset(1e-3);
  const auto momentum = [&] {
    Vec3d sum{};
    for (const Vec3f& v : scene.velocities()) sum += toDouble(v);
    return sum;
  };
  double scale = 0;
  for (const Vec3f& v : velocities) scale += length(toDouble(v));
  const Vec3d before = momentum();
  scene.step(1000);
  return length(momentum() - before) / scale;
}

TEST(SemiImplicitSolver, MomentumOfFreeBlobDriftsLittle) {
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    const double drift = momentumDrift(*device, 0, 3);
    std::printf("momentum drift of a free blob on %s: %.2g of its scale in 1000 steps\n", name.c_str(),
                drift);
    EXPECT_LT(drift, 1e-5) << name;
  }
}

// A division by a number of each particle's own conserves momentum only at convergence: a blob that starts in
// disorder, strongly compressed in places, loses some with few iterations, and less with more.
TEST(SemiImplicitSolver, MomentumOfDisorderedBlobIsConservedAtConvergence) {
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    const double few = momentumDrift(*device, 0.1f, 3), many = momentumDrift(*device, 0.1f, 200);
    std::printf("momentum drift of a disordered blob on %s: %.2g with 3 iterations, %.2g with 200\n",
                name.c_str(), few, many);
    EXPECT_LT(few, 5e-3) << name;
    EXPECT_LT(many, few / 10) << name;
  }
}

TEST(SemiImplicitSolver, CoincidentParticlesSeparate) {
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    FluidScene scene(*device, {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}, {}, object({{"spacing", 0.01}}));
    scene.gravity = {};
    scene.reset(1e-3);
    scene.step(200);
    const std::vector<Vec3f> p = scene.positions();
    EXPECT_GT(length(p[0] - p[1]), 0.002f) << name;
    EXPECT_GT(length(p[1] - p[2]), 0.002f) << name;
    EXPECT_GT(length(p[0] - p[2]), 0.002f) << name;
  }
}

// Eight particles at a time, of which some share a place.
TEST(SemiImplicitSolver, CoincidentParticlesAmongManySeparateAlikeWithAllInstructionsOfTheCpu) {
  std::vector<Vec3f> start;
  for (int i = 0; i < 45; ++i)
    for (int copy = 0; copy < 1 + i % 3; ++copy)
      start.push_back({0.01f * float(i % 5), 0.01f * float(i / 5 % 3), 0.01f * float(i / 15)});
  std::vector<Vec3f> expected;
  for (const CpuIsa isa : usableCpuIsas()) {
    CpuDevice device(2, isa);
    FluidScene scene(device, start, {}, object({{"spacing", 0.01}}));
    scene.gravity = {};
    scene.reset(1e-3);
    scene.step(20);
    const std::vector<Vec3f> p = scene.positions();
    if (expected.empty()) expected = p;
    EXPECT_EQ(p, expected) << cpuIsaName(isa);
    for (std::size_t a = 0; a < p.size(); ++a)
      for (std::size_t b = 0; b < a; ++b)
        EXPECT_GT(length(p[a] - p[b]), 1e-4f) << cpuIsaName(isa) << ", particles " << b << " and " << a;
  }
}

TEST(FluidConstants, LatticeCalibration) {
  EXPECT_NEAR(latticeCalibration(1.2), 0.35213, 5e-6);
  EXPECT_NEAR(latticeCalibration(1.5), 0.57728, 5e-6);
  EXPECT_NEAR(latticeCalibration(2.0), 0.80913, 5e-6);
  EXPECT_NEAR(latticeCalibration(2.5), 0.91222, 5e-6);
}

TEST(FluidConstants, KernelIntegratesToItsCalibrationAndItsSlopeIsItsDerivative) {
  const FluidConstants c = makeFluidConstants(0.01f, 1.5f, 1000, 1e6f, Calibration::kLattice);
  constexpr int kShells = 20000;
  double integral = 0;
  for (int k = 0; k < kShells; ++k) {
    const double r = (k + 0.5) * c.supportRadius / kShells;
    integral += 4 * std::numbers::pi * r * r * c.kernel.value(float(r)) * c.supportRadius / kShells;
  }
  EXPECT_NEAR(integral, c.calibration, 1e-4);
  for (const float r : {0.001f, 0.005f, 0.01f, 0.014f}) {
    const float h = 1e-4f * c.supportRadius;
    const double difference = (double(c.kernel.value(r + h)) - c.kernel.value(r - h)) / (2.0 * h);
    EXPECT_NEAR(-c.kernel.slope(r), difference, 1e-3 * c.kernel.slope0);
  }
}

}  // namespace
}  // namespace weir::test
