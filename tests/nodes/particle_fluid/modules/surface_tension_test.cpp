// Surface tension against a double-precision version, its conservation law, and the shape of a drop.
#include "nodes/particle_fluid/modules/surface_tension.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/nodes/particle_fluid/modules/module_test_support.h"
#include "tests/support/expect_error.h"

namespace weir::test {
namespace {

constexpr float kSpacing = 0.01f;

Value withTension(double coefficient, double airPressure) {
  return object(
      {{"tension", inserted("SurfaceTension", "viscosity",
                            object({{"coefficient", coefficient}, {"air_pressure", airPressure}}))}});
}

/// Modules that leave positions alone, so that the forces of one step show in the velocities.
Value tensionOnly(double coefficient, double airPressure) {
  Value modules = withTension(coefficient, airPressure);
  modules["solver"] = disabled();
  modules["viscosity"] = disabled();
  return modules;
}

TEST(SurfaceTension, AgreesWithDoublePrecision) {
  const std::vector<Vec3f> positions = jitteredCube(9, kSpacing, 0.2f, 3, {0.1f, 0, 0.2f});
  const ReferenceFluid reference = referenceWith({.spacing = kSpacing, .supportRatio = 2.0}, positions,
                                                 std::vector<Vec3f>(positions.size()));
  constexpr double kDt = 1e-3;
  for (const double airPressure : {0.0, 20.0}) {
    std::vector<Vec3d> expected = surfaceTension(reference, 0.05, airPressure);
    double max = 0;
    for (Vec3d& v : expected) v *= kDt, max = std::max(max, length(v));
    for (const std::string& name : availableDevices()) {
      const auto device = openDevice(name);
      FluidScene scene(*device, positions, {}, object({{"spacing", kSpacing}, {"support_ratio", 2.0}}),
                       tensionOnly(0.05, airPressure));
      scene.gravity = {};
      scene.reset(kDt);
      scene.step();
      EXPECT_LT(largestDifference(scene.velocities(), expected), 2e-5 * max) << name;
      EXPECT_LT(length(sumOf(scene.velocities())), 1e-6 * max * double(positions.size())) << name;
    }
  }
}

TEST(SurfaceTension, RefusesWhatIsNoTension) {
  const auto refusal = [](const char* parameter, double value) {
    return std::string(errorOf([&] {
                         SurfaceTension module;
                         module.assignAll(object({{parameter, value}}), {"test", "", ""});
                       }).what());
  };
  EXPECT_CONTAINS(refusal("coefficient", -1), "at least 0");
  EXPECT_CONTAINS(refusal("coefficient", 1e30), "at most");
  EXPECT_CONTAINS(refusal("air_pressure", -1), "at least 0");
  EXPECT_CONTAINS(refusal("air_pressure", 1e30), "at most");
}

TEST(SurfaceTension, WarnsOfASmallSupport) {
  CpuDevice device(1);
  std::vector<std::string> warnings;
  Log log([&](LogLevel level, std::string_view text) {
    if (level == LogLevel::kWarning) warnings.emplace_back(text);
  });
  for (const float ratio : {1.5f, 2.0f}) {
    ParticleSet particles(device);
    NeighborList neighbors(device);
    const std::vector<const Boundary*> boundaries;
    const FluidConstants constants = makeFluidConstants(kSpacing, ratio, 1000, 1e6f, Calibration::kPacking);
    const StepContext time{device, log, {}, 0, 1e-3, 0};
    WallField walls(device);
    FluidStep fluid{time, device, constants, particles, neighbors, boundaries, {}, {}, walls};
    SurfaceTension module;
    module.setName("tension");
    module.reset(fluid);
  }
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_CONTAINS(warnings[0], "support_ratio");
  EXPECT_CONTAINS(warnings[0], "1.5");
}

// The moments of a body about its centre that tell a ball from a cube.
struct Shape {
  /// ⟨r²⟩ of the ball that has the volume n·d³ of the particles, over their own ⟨r²⟩, the trace of their
  /// second moments. No body of that volume exceeds 1, a ball's; a cube has 0.924.
  double sphericity;
  /// ⟨x⁴ + y⁴ + z⁴⟩ / ⟨r⁴⟩: 0.6 for a ball, 0.474 for a cube of any size. Unlike the sphericity it does not
  /// change if the particles only move closer together.
  double cubicMoment;
  double axisRatio;  ///< least over largest of the three ⟨x²⟩
};

Shape shapeOf(const std::vector<Vec3f>& positions) {
  const double n = double(positions.size());
  const Vec3d center = sumOf(positions) / n;
  Vec3d second{};
  double fourth = 0, axes = 0;
  for (const Vec3f& p : positions) {
    const Vec3d d = toDouble(p) - center, squares{d.x * d.x, d.y * d.y, d.z * d.z};
    second += squares / n;
    fourth += dot(d, d) * dot(d, d);
    axes += dot(squares, squares);
  }
  const double volume = n * std::pow(double(kSpacing), 3);
  const double ball = 3.0 / 5 * std::pow(3 * volume / (4 * std::numbers::pi), 2.0 / 3);
  const auto [min, max] = std::minmax({second.x, second.y, second.z});
  return {ball / (second.x + second.y + second.z), axes / fourth, min / max};
}

TEST(SurfaceTension, CubeBecomesSphere) {
  const std::vector<Vec3f> cube = jitteredCube(10, kSpacing, 0, 1);
  const Shape before = shapeOf(cube);
  EXPECT_LT(before.sphericity, 0.94);
  EXPECT_LT(before.cubicMoment, 0.48);
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    Value modules = withTension(0.03, 20);
    modules["viscosity"] = object({{"params", object({{"form", "explicit"}, {"strength", 0.05}})}});
    FluidScene scene(*device, cube, {},
                     object({{"spacing", kSpacing}, {"support_ratio", 2.5}, {"calibration", "lattice"}}),
                     modules);
    scene.gravity = {};
    scene.reset(1e-3);
    for (int frame = 0; frame < 10; ++frame) scene.step(100), scene.frame();
    const Shape after = shapeOf(scene.positions());
    const double drift = length(sumOf(scene.velocities())) / double(cube.size());
    std::printf("drop on %s: sphericity %.4f, cubic moment %.4f, axis ratio %.4f, mean velocity %.2g m/s\n",
                name.c_str(), after.sphericity, after.cubicMoment, after.axisRatio, drift);
    EXPECT_GT(after.sphericity, 0.98) << name;
    EXPECT_LT(after.sphericity, 1.03) << name;  // more would be lost volume
    EXPECT_NEAR(after.cubicMoment, 0.6, 0.015) << name;
    EXPECT_GT(after.axisRatio, 0.95) << name;
    EXPECT_LT(drift, 1e-3) << name;
  }
}

/// The fastest particle of a drop after 0.2 s without gravity, at a step of 2 ms.
double speedOfDrop(Device& device, double coefficient, float supportRatio,
                   std::vector<std::string>& warnings) {
  FluidScene scene(device, jitteredCube(8, kSpacing, 0, 1), {},
                   object({{"spacing", kSpacing}, {"support_ratio", supportRatio}}),
                   withTension(coefficient, 0));
  scene.gravity = {};
  scene.reset(2e-3);
  warnings.clear();
  for (const std::string& warning : scene.warnings())
    if (contains(warning, "'tension'")) warnings.push_back(warning);  // the solver has its own at this step
  scene.step(100);
  scene.frame();
  double max = 0;
  for (const Vec3f& v : scene.velocities()) max = std::max(max, double(length(v)));
  return max;
}

TEST(SurfaceTension, FliesApartWhereItWarnsOfTheStep) {
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    for (const float supportRatio : {2.0f, 2.5f}) {
      std::vector<std::string> calmWarnings, wildWarnings;
      // κ·dt²/(ρ0·d⁴) = κ·0.4/N.
      const double calm = speedOfDrop(*device, 1, supportRatio, calmWarnings);
      const double wild = speedOfDrop(*device, 10, supportRatio, wildWarnings);
      std::printf("support ratio %.1f on %s: fastest particle %.3g m/s at 0.4, %.3g m/s at 4\n", supportRatio,
                  name.c_str(), calm, wild);
      EXPECT_TRUE(calmWarnings.empty());
      ASSERT_EQ(wildWarnings.size(), 1u);
      EXPECT_CONTAINS(wildWarnings[0], "node 'water', module 'tension'");
      EXPECT_CONTAINS(wildWarnings[0], "coefficient·dt²/(rest_density·spacing⁴) = 4");
      EXPECT_CONTAINS(wildWarnings[0], "at most 1.2 N");
      EXPECT_LT(calm, 0.5);
      EXPECT_GT(wild, 4 * calm);
    }
  }
}

}  // namespace
}  // namespace weir::test
