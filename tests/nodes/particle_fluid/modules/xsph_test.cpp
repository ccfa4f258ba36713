// XSPH by time against the decay of a shear flow, its implicit form against a double-precision version;
// stability, momentum, and its parameters. The explicit form is tested with the solver.
#include "nodes/particle_fluid/modules/xsph.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

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

/// A shear flow, vx = cos(k·y), of this many layers of a lattice, 4 spacings long and wide.
struct ShearFlow {
  static constexpr int kSide = 4;
  int layers;

  float wave(float y) const {
    return static_cast<float>(std::cos(2 * std::numbers::pi * double(y / kSpacing) / layers));
  }
  std::vector<Vec3f> positions() const {
    std::vector<Vec3f> all;
    for (int y = 0; y < layers; ++y)
      for (int x = 0; x < kSide; ++x)
        for (int z = 0; z < kSide; ++z) all.push_back(kSpacing * Vec3f{x + 0.5f, y + 0.5f, z + 0.5f});
    return all;
  }
  std::vector<Vec3f> velocities(float speed) const {
    std::vector<Vec3f> all;
    for (const Vec3f& p : positions()) all.push_back({speed * wave(p.y), 0, 0});
    return all;
  }
  double amplitude(const std::vector<Vec3f>& velocities) const {
    double sum = 0, all = 0;
    const std::vector<Vec3f> at = positions();
    for (std::size_t i = 0; i < at.size(); ++i) {
      sum += double(velocities[i].x * wave(at[i].y));
      all += double(wave(at[i].y) * wave(at[i].y));
    }
    return sum / all;
  }
  /// V0·Σ(1 − cos(k·y))·W over a lattice, whose V0·ΣW is 1, for a support of `ratio` spacings.
  double share(double ratio) const {
    double sum = 0, all = 0;
    for (int x = -2; x <= 2; ++x)
      for (int y = -2; y <= 2; ++y)
        for (int z = -2; z <= 2; ++z) {
          const double q = std::sqrt(double(x * x + y * y + z * z)) / ratio;
          const double w = q < 1 ? std::pow(1 - q, 3) : 0;
          all += w;
          sum += w * (1 - std::cos(2 * std::numbers::pi * y / layers));
        }
    return sum / all;
  }
  /// With XSPH of these parameters alone, after a time; of 1 at first.
  double after(Device& device, Value params, double dt, double time) const {
    constexpr float kSpeed = 1e-3f;
    const auto vec = [](float x, float y, float z) -> Value {
      return Value::Array{double(x), double(y), double(z)};
    };
    FluidScene scene(
        device, positions(), velocities(kSpeed),
        object({{"spacing", kSpacing},
                {"calibration", "lattice"},
                {"periodic", "xyz"},
                {"domain_min", vec(0, 0, 0)},
                {"domain_max", vec(kSide * kSpacing, layers * kSpacing, kSide * kSpacing)}}),
        object({{"solver", disabled()}, {"viscosity", object({{"params", std::move(params)}})}}));
    scene.gravity = {};
    scene.reset(dt);
    scene.step(int(std::lround(time / dt)));
    return amplitude(scene.velocities()) / kSpeed;
  }
};

TEST(Xsph, AShearFlowDecaysAtItsRateWhateverTheTimeStep) {
  // exp(−rate·share·t) as dt → 0; with sweeps of c, ln(1 − c·share)/c in place of −share, which is c·share/2
  // more of it.
  constexpr double kRate = 400, kTime = 0.06;
  const ShearFlow flow{24};
  const double share = flow.share(1.5);
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    std::vector<double> found;
    for (const double dt : {5e-4, 2e-3, 6e-3}) {  // c = 0.2; 0.8; three sweeps of 0.8
      found.push_back(-std::log(flow.after(*device, object({{"rate", kRate}}), dt, kTime)) / kTime);
      EXPECT_NEAR(found.back(), kRate * share, 0.01 * kRate * share) << name << ", " << dt;
    }
    EXPECT_NEAR(found[1], found[0], 0.01 * found[0]) << name;
    EXPECT_NEAR(found[2], found[1], 1e-3 * found[0]) << name;
  }
}

TEST(Xsph, TheExplicitFormCountsInSteps) {
  const ShearFlow flow{24};
  CpuDevice device(2);
  const Value params = object({{"form", "explicit"}, {"strength", 0.4}});
  const double once = -std::log(flow.after(device, params, 2e-3, 0.06)),
               twice = -std::log(flow.after(device, params, 1e-3, 0.06));
  EXPECT_NEAR(twice, 2 * once, 0.01 * once);
  EXPECT_EQ(flow.after(device, params, 2e-3, 0.02),
            flow.after(device, object({{"rate", 200.0}}), 2e-3, 0.02));
}

TEST(Xsph, WarnsOfARateThatTakesManySweeps) {
  CpuDevice device(1);
  const auto warnings = [&](double rate) {
    FluidScene scene(device, {{0, 0, 0}}, {{0, 0, 0}}, object({{"spacing", kSpacing}}),
                     object({{"viscosity", object({{"params", object({{"rate", rate}})}})}}));
    scene.gravity = {};
    scene.reset(2e-3);
    std::vector<std::string> found;
    for (const std::string& warning : scene.warnings())
      if (warning.find("sweeps") != std::string::npos) found.push_back(warning);
    return found;
  };
  ASSERT_EQ(warnings(6000).size(), 1u);
  EXPECT_CONTAINS(warnings(6000).front(), "12 sweeps in a step of 0.002 s");
  EXPECT_CONTAINS(warnings(6000).front(), "at most 4e+03 1/s");
  EXPECT_TRUE(warnings(4000).empty());
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
  EXPECT_CONTAINS(errorOf([&] { assign(object({{"strength", 0.2}})); }).what(), "as form: explicit");
  EXPECT_CONTAINS(errorOf([&] {
                    assign(object({{"form", "explicit"}, {"rate", 2.0}}));
                  }).what(),
                  "as form: per_time");
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
