// The implicit form of XSPH against a double-precision version; stability, momentum, and its parameters. The
// explicit form is tested with the solver.
#include "nodes/particle_fluid/modules/xsph.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/nodes/particle_fluid/modules/module_test_support.h"
#include "tests/support/expect_error.h"

namespace weir::test {
namespace {

constexpr float kSpacing = 0.01f;
constexpr double kDt = 1e-3;

/// Only the viscosity changes velocities.
Value implicitOnly(double viscosity) {
  return object(
      {{"solver", disabled()},
       {"viscosity", object({{"params", object({{"form", "implicit"}, {"viscosity", viscosity}})}})}});
}

std::vector<Vec3f> smoothed(Device& device, const std::vector<Vec3f>& positions,
                            const std::vector<Vec3f>& velocities, double viscosity, int steps = 1) {
  FluidScene scene(device, positions, velocities, object({{"spacing", kSpacing}, {"calibration", "lattice"}}),
                   implicitOnly(viscosity));
  scene.gravity = {};
  scene.reset(kDt);
  scene.step(steps);
  return scene.velocities();
}

double fastest(const std::vector<Vec3f>& velocities) {
  double max = 0;
  for (const Vec3f& v : velocities) max = std::max(max, length(toDouble(v)));
  return max;
}

TEST(ImplicitXsph, AgreesWithDoublePrecision) {
  const std::vector<Vec3f> positions = jitteredCube(10, kSpacing, 0.2f, 3);
  const std::vector<Vec3f> velocities = randomVelocities(positions.size(), 0.5f, 4);
  for (const double viscosity : {0.5, 15.0, 1e5}) {
    ReferenceFluid reference = referenceWith(
        {.spacing = kSpacing, .supportRatio = 1.5, .dt = kDt, .gravity = {}}, positions, velocities);
    reference.predict();
    for (const std::string& name : availableDevices()) {
      const auto device = openDevice(name);
      EXPECT_LT(largestDifference(smoothed(*device, positions, velocities, viscosity),
                                  implicitXsph(reference, viscosity)),
                1e-5)
          << name << ", viscosity " << viscosity;
    }
  }
}

TEST(ImplicitXsph, IsStableForAnyViscosityAndKeepsTheLoneParticle) {
  std::vector<Vec3f> positions = jitteredCube(8, kSpacing, 0.2f, 3);
  std::vector<Vec3f> velocities = randomVelocities(positions.size(), 0.1f, 4);
  positions.push_back({1, 1, 1});
  velocities.push_back({0.1f, 0, 0});
  for (const double viscosity : {1.0, 1e4, 1e30})
    for (const std::string& name : availableDevices()) {
      const auto device = openDevice(name);
      const std::vector<Vec3f> after = smoothed(*device, positions, velocities, viscosity, 50);
      ASSERT_EQ(after.size(), positions.size());
      // A mean of velocities is no faster than the fastest of them.
      EXPECT_LE(fastest(after), fastest(velocities) * (1 + 1e-5)) << name << ", viscosity " << viscosity;
      EXPECT_EQ(after.back(), velocities.back()) << name;
    }
}

TEST(ImplicitXsph, DecaysAtItsRateWhateverTheTimeStep) {
  // Two particles approach their mean; their difference decays by dv/dt = −2·(ν/H)·v, to first order in dt.
  constexpr float kSpeed = 1e-3f;
  constexpr double kViscosity = 0.3, kRate = 2 * kViscosity / (1.5 * kSpacing), kTime = 0.02;
  for (const double dt : {1e-3, 1e-4}) {
    for (const std::string& name : availableDevices()) {
      const auto device = openDevice(name);
      FluidScene scene(*device, {{0, 0, 0}, {kSpacing, 0, 0}}, {{0, kSpeed, 0}, {0, -kSpeed, 0}},
                       object({{"spacing", kSpacing}}), implicitOnly(kViscosity));
      scene.gravity = {};
      scene.reset(dt);
      scene.step(int(std::lround(kTime / dt)));
      const double b = kRate / 2 * dt;
      EXPECT_NEAR(scene.velocities()[0].y / kSpeed, std::exp(-kRate * kTime), 2 * b * kRate * kTime) << name;
    }
  }
}

TEST(ImplicitXsph, MomentumDriftIsSmall) {
  const std::vector<Vec3f> positions = jitteredCube(12, kSpacing, 0.2f, 3);
  std::vector<Vec3f> velocities = randomVelocities(positions.size(), 0.5f, 4);
  double scale = 0;
  for (const Vec3f& v : velocities) scale += length(toDouble(v));
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    const auto drift = [&](double viscosity) {
      return length(sumOf(smoothed(*device, positions, velocities, viscosity)) - sumOf(velocities)) / scale;
    };
    const double thin = drift(1), thick = drift(1e4);
    std::printf(
        "momentum drift of implicit XSPH on %s: %.2g of its scale in a step at 1 m/s, %.2g at 1e4 m/s\n",
        name.c_str(), thin, thick);
    EXPECT_LT(thin, 1e-2) << name;
    EXPECT_LT(thick, 5e-2) << name;
  }
}

TEST(Xsph, RefusesTheParameterOfTheOtherForm) {
  const auto assign = [](Value params) {
    Xsph module;
    module.assignAll(params, {"test", "", ""});
  };
  EXPECT_CONTAINS(errorOf([&] { assign(object({{"viscosity", 2.0}})); }).what(), "implicit");
  EXPECT_CONTAINS(errorOf([&] {
                    assign(object({{"form", "implicit"}, {"strength", 0.2}}));
                  }).what(),
                  "strength");
  EXPECT_CONTAINS(errorOf([&] {
                    assign(object({{"form", "implicit"}, {"viscosity", -1.0}}));
                  }).what(),
                  "at least 0");
  EXPECT_NO_THROW(assign(object({{"form", "implicit"}, {"viscosity", 2.0}})));
}

}  // namespace
}  // namespace weir::test
