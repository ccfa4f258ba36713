// Fluids that meet rigid meshes: against double precision, closed forms of hydrostatics, and conservation.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/nodes/particle_fluid/modules/module_test_support.h"
#include "tests/nodes/semi_analytical_sfi/solid_scene.h"
#include "tests/support/expect_error.h"
#include "tests/support/meshes.h"

namespace weir::test {
namespace {

/// The integrals over the half-space y < 0 in closed form, for the spiky kernel with s = 1.
ReferenceFluid::Wall halfSpace(const Vec3d& p, double radius) {
  const double q = p.y / radius;
  if (q >= 1) return {};
  const double t = 1 - q;
  return {0.5 * std::pow(t, 5) * (1 + 2 * q),
          {0, -1.5 * std::pow(t, 4) * (1 + 4 * q) / radius, 0},
          7.5 * std::pow(t, 4) / (radius * radius)};
}

/// A tank's worth of solid ground with its top at y = 0.
TriangleMesh ground() {
  return boxMesh({-2, -1, -2}, {2, 0, 2});
}

TEST(SemiAnalyticalSFI, OneStepOnTheGroundAgreesWithDoublePrecision) {
  for (const bool conservative : {true, false}) {
    constexpr float kSpacing = 0.02f, kRatio = 1.5f;
    const double dt = 2e-3;
    // Compressed and falling, all particles more than the collision gap above the ground.
    std::vector<Vec3f> positions =
        jitteredCube(10, 0.95f * kSpacing, 0.1f, 7, {-0.1f, 0.35f * kSpacing, -0.1f});
    const std::vector<Vec3f> velocities(positions.size(), Vec3f{0.1f, 0, 0.05f});
    ReferenceFluid reference{
        .spacing = kSpacing, .supportRatio = kRatio, .dt = dt, .conservative = conservative};
    reference.wall = [&](const Vec3d& p) { return halfSpace(p, reference.radius()); };
    for (const Vec3f& p : positions) reference.positions.push_back(toDouble(p));
    for (const Vec3f& v : velocities) reference.velocities.push_back(toDouble(v));
    reference.step();
    for (const std::string& name : availableDevices()) {
      const auto device = openDevice(name);
      SolidScene scene(*device, positions, velocities,
                       object({{"spacing", kSpacing}, {"calibration", "lattice"}, {"mu", 1.0}}),
                       object({{"solver", object({{"params", object({{"conservative", conservative}})}})},
                               {"viscosity", object({{"enabled", false}})}}));
      SemiAnalyticalSFI& contact = scene.couple({ground()});
      scene.reset(dt);
      scene.step();
      ASSERT_EQ(scene.fluid().particleCount(), 1000);
      EXPECT_LT(largestDifference(scene.positions(), reference.positions) / kSpacing, 1e-4) << name;
      EXPECT_LT(largestDifference(scene.velocities(), reference.velocities) * dt / kSpacing, 1e-4) << name;
      scene.frame();
      const Vec3d impulse = dt * contact.forces->solids.front().force;
      EXPECT_NEAR(impulse.y, -reference.wallImpulse.y, 1e-4 * std::abs(reference.wallImpulse.y)) << name;
    }
  }
}

}  // namespace
}  // namespace weir::test
