// Vorticity against a rigid rotation, and its confinement against a double-precision version.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/nodes/particle_fluid/modules/module_test_support.h"

namespace weir::test {
namespace {

constexpr float kSpacing = 0.01f;
constexpr double kDt = 1e-3;

/// Only the confinement changes velocities.
Value confinementOnly(double strength) {
  return object(
      {{"solver", disabled()},
       {"viscosity", disabled()},
       {"eddies", inserted("VorticityConfinement", "viscosity", object({{"strength", strength}}))}});
}

TEST(VorticityConfinement, RigidRotationHasTwiceItsSpinAndIsLeftAlone) {
  const Vec3f spin{2, -1, 3};  // 1/s
  const float extent = 11 * kSpacing, middle = extent / 2;
  const std::vector<Vec3f> positions = jitteredCube(12, kSpacing, 0, 1, {-middle, -middle, -middle});
  std::vector<Vec3f> velocities;
  for (const Vec3f& p : positions) velocities.push_back(cross(spin, p));
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    FluidScene scene(*device, positions, velocities, object({{"spacing", kSpacing}, {"support_ratio", 1.5}}),
                     confinementOnly(5));
    scene.gravity = {};
    scene.reset(1e-4);
    scene.step();
    const ParticleSet& particles = scene.fluid().fluid->set();
    const std::vector<Vec3f> found = particles.get<Vec3f>("vorticity").toHost(particles.bound());
    const std::vector<std::int64_t> ids = particles.ids().toHost(particles.bound());
    const std::vector<Vec3f> after = scene.velocities();
    int inside = 0;
    for (std::size_t k = 0; k < ids.size(); ++k) {
      const auto id = static_cast<std::size_t>(ids[k]);
      const Vec3f p = positions[id];
      // Two layers from the faces, all neighbours and their neighbours are there.
      if (std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) > middle - 1.9f * kSpacing) continue;
      ++inside;
      EXPECT_LT(length(found[k] - 2.0f * spin), 1e-3f * length(spin)) << name;
      EXPECT_LT(length(after[id] - velocities[id]), 1e-6f) << name;
    }
    EXPECT_EQ(inside, 8 * 8 * 8) << name;
  }
}

TEST(VorticityConfinement, AgreesWithDoublePrecision) {
  const std::vector<Vec3f> positions = jitteredCube(10, kSpacing, 0.2f, 3);
  std::vector<Vec3f> velocities;
  for (const Vec3f& p : positions)  // eddies of 4 and 6 cm
    velocities.push_back({std::sin(157 * p.y), 0.5f * std::sin(105 * p.z), std::cos(157 * p.x)});
  ReferenceFluid reference = referenceWith(
      {.spacing = kSpacing, .supportRatio = 1.5, .dt = kDt, .gravity = {}}, positions, velocities);
  reference.predict();
  const double strength = 20;
  const std::vector<Vec3d> expected = confineVorticity(reference, strength);
  const double change = largestDifference(velocities, expected);
  EXPECT_GT(change, 0.01);
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    FluidScene scene(*device, positions, velocities, object({{"spacing", kSpacing}, {"support_ratio", 1.5}}),
                     confinementOnly(strength));
    scene.gravity = {};
    scene.reset(kDt);
    scene.step();
    EXPECT_LT(largestDifference(scene.velocities(), expected), 1e-3 * change) << name;
  }
}

TEST(VorticityConfinement, SpeedsUpTheRimOfAnEddy) {
  // A column whose spin falls off from its axis: n points to the axis, and n × ω along the flow.
  const float middle = 7.5f * kSpacing;
  const std::vector<Vec3f> positions = jitteredCube(16, kSpacing, 0, 1, {-middle, -middle, -middle});
  std::vector<Vec3f> velocities;
  for (const Vec3f& p : positions) {
    const float radius2 = p.x * p.x + p.z * p.z;
    velocities.push_back(10 * std::exp(-radius2 / (2 * 0.03f * 0.03f)) * Vec3f{p.z, 0, -p.x});
  }
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    FluidScene scene(*device, positions, velocities, object({{"spacing", kSpacing}}), confinementOnly(5));
    scene.gravity = {};
    scene.reset(kDt);
    scene.step();
    const std::vector<Vec3f> after = scene.velocities();
    for (std::size_t i = 0; i < positions.size(); ++i) {
      const Vec3f p = positions[i];
      const float radius = std::sqrt(p.x * p.x + p.z * p.z);
      if (radius < 0.015f || radius > 0.03f || std::abs(p.y) > 0.05f) continue;
      EXPECT_GT(length(after[i]), length(velocities[i])) << name;
    }
  }
}

}  // namespace
}  // namespace weir::test
