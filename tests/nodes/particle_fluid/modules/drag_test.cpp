// Drag and damping against the closed forms of a single particle's motion.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/nodes/particle_fluid/modules/module_test_support.h"

namespace weir::test {
namespace {

constexpr double kSpacing = 0.01, kAirDensity = 100, kCoefficient = 0.47;

/// k of dv/dt = −k·v², for a ball of the particle's volume in water.
double dragPerLength() {
  const double radius = std::cbrt(3.0 / (4 * std::numbers::pi)) * kSpacing;
  const double mass = 1000 * std::pow(kSpacing, 3);
  return 0.5 * kAirDensity * kCoefficient * std::numbers::pi * radius * radius / mass;
}

Value withDrag(Value params) {
  return object({{"air", inserted("Drag", "viscosity", std::move(params))}});
}

Value dense() {
  return object({{"air_density", kAirDensity}, {"drag_coefficient", kCoefficient}});
}

std::vector<Vec3f> velocitiesAfter(Device& device, const std::vector<Vec3f>& positions, const Vec3f& velocity,
                                   const Value& drag, double dt, int steps, const Vec3f& gravity = {}) {
  FluidScene scene(device, positions, std::vector<Vec3f>(positions.size(), velocity),
                   object({{"spacing", kSpacing}}), withDrag(drag));
  scene.gravity = gravity;
  scene.reset(dt);
  scene.step(steps);
  return scene.velocities();
}

TEST(Drag, LoneParticleSlowsAsTheClosedFormSays) {
  const Vec3f velocity{6, 0, 8};
  constexpr double kTime = 0.5;
  const double expected = 10 / (1 + dragPerLength() * 10 * kTime);
  EXPECT_LT(expected, 5);
  for (const std::string& name : availableDevices())
    for (const int steps : {1, 10, 500}) {  // exact for any dt
      const auto device = openDevice(name);
      const Vec3f v = velocitiesAfter(*device, {{0, 0, 0}}, velocity, dense(), kTime / steps, steps)[0];
      EXPECT_NEAR(length(v), expected, 1e-4 * expected) << name;
      EXPECT_NEAR(v.x / v.z, 0.75, 1e-5) << name;
    }
}

TEST(Drag, FallingParticleReachesItsTerminalSpeed) {
  const double terminal = std::sqrt(9.8 / dragPerLength());
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    const Vec3f v = velocitiesAfter(*device, {{0, 0, 0}}, {}, dense(), 1e-3, 5000, {0, -9.8f, 0})[0];
    EXPECT_NEAR(v.y, -terminal, 0.01 * terminal) << name;
  }
}

TEST(Drag, WindCarriesAlong) {
  Value drag = dense();
  drag["wind"] = Value::Array{3.0, 0.0, 0.0};
  constexpr double kTime = 0.5;
  const double expected = 3 - 3 / (1 + dragPerLength() * 3 * kTime);
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    EXPECT_NEAR(velocitiesAfter(*device, {{0, 0, 0}}, {}, drag, 1e-2, 50)[0].x, expected, 1e-4) << name;
  }
}

TEST(Drag, DampingIsExponential) {
  for (const std::string& name : availableDevices())
    for (const int steps : {1, 100}) {
      const auto device = openDevice(name);
      const Vec3f v =
          velocitiesAfter(*device, {{0, 0, 0}}, {0, 2, 0}, object({{"air_density", 0.0}, {"damping", 3.0}}),
                          0.4 / steps, steps)[0];
      EXPECT_NEAR(v.y, 2 * std::exp(-1.2), 1e-5) << name;
    }
}

TEST(Drag, ActsOnExposedParticlesOrOnAll) {
  // A pair, each the other's only neighbour, and a block.
  std::vector<Vec3f> positions = jitteredCube(9, float(kSpacing), 0, 1);
  const std::size_t pair = positions.size(), inside = (4 * 9 + 4) * 9 + 4;
  positions.push_back({1, 1, 1});
  positions.push_back({1.01f, 1, 1});
  constexpr double kSpeed = 10, kDt = 1e-3;
  const auto slowed = [&](double exposed) { return kSpeed / (1 + exposed * dragPerLength() * kSpeed * kDt); };
  const double max = 2.0 / 3 * std::numbers::pi * std::pow(1.5, 3);
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    const auto after = [&](const char* on) {
      Value drag = dense();
      drag["on"] = on;
      FluidScene scene(*device, positions, std::vector<Vec3f>(positions.size(), {0, float(kSpeed), 0}),
                       object({{"spacing", kSpacing}, {"calibration", "lattice"}}), withDrag(drag));
      scene.gravity = {};
      scene.reset(kDt);
      scene.step();
      return scene.velocities();
    };
    const std::vector<Vec3f> exposed = after("exposed"), all = after("all");
    EXPECT_FLOAT_EQ(exposed[inside].y, float(kSpeed)) << name;
    EXPECT_NEAR(exposed[pair].y, slowed(1 - 1 / max), 1e-5) << name;
    EXPECT_NEAR(all[inside].y, slowed(1), 1e-5) << name;
    EXPECT_NEAR(all[pair].y, slowed(1), 1e-5) << name;
  }
}

}  // namespace
}  // namespace weir::test
