// Position based fluids against a double-precision version.
#include <gtest/gtest.h>

#include <cmath>

#include "nodes/particle_fluid/modules/pbf.h"
#include "tests/nodes/particle_fluid/modules/module_test_support.h"
#include "tests/support/expect_error.h"

namespace weir::test {
namespace {

struct PbfCase {
  float spacing, supportRatio;
  const char* form;
  double epsilon, artificialPressure;  // of the textbook form
};

class PbfOneStep : public testing::TestWithParam<PbfCase> {};

Value pbf(const PbfCase& c) {
  Value params = object({{"form", c.form}});
  if (c.form == std::string("textbook")) {
    params["epsilon"] = c.epsilon;
    params["artificial_pressure"] = c.artificialPressure;
  }
  return object({{"type", "Pbf"}, {"params", std::move(params)}});
}

TEST_P(PbfOneStep, AgreesWithDoublePrecision) {
  const PbfCase& c = GetParam();
  constexpr double kDt = 1e-3;
  const std::vector<Vec3f> positions = jitteredCube(12, c.spacing, 0.2f, 7, {0.1f, 0.2f, -0.05f});
  const std::vector<Vec3f> velocities = randomVelocities(positions.size(), 0.5f, 8);
  ReferenceFluid reference =
      referenceWith({.spacing = c.spacing, .supportRatio = c.supportRatio, .dt = kDt}, positions, velocities);
  stepWithPbf(reference, {.textbook = c.form == std::string("textbook"),
                          .epsilon = c.epsilon,
                          .artificialPressure = c.artificialPressure});

  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    FluidScene scene(
        *device, positions, velocities,
        object({{"spacing", c.spacing}, {"support_ratio", c.supportRatio}, {"calibration", "lattice"}}),
        object({{"solver", pbf(c)}, {"viscosity", disabled()}}));
    scene.reset(kDt);
    scene.step();
    EXPECT_LT(largestDifference(scene.positions(), reference.positions) / c.spacing, 1e-4) << name;
    EXPECT_LT(largestDifference(scene.velocities(), reference.velocities) * kDt / c.spacing, 1e-4) << name;
    // The solver has moved something.
    EXPECT_GT(largestDifference(velocities, reference.velocities) * kDt / c.spacing, 1e-3);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Settings, PbfOneStep,
    testing::Values(PbfCase{0.01f, 1.2f, "textbook", 0.01, 0}, PbfCase{0.01f, 1.5f, "textbook", 0.1, 0},
                    PbfCase{0.02f, 1.5f, "textbook", 0.01, 1e-3}, PbfCase{0.04f, 2.0f, "textbook", 0.01, 0},
                    PbfCase{0.01f, 1.2f, "unnormalized", 0, 0}, PbfCase{0.02f, 1.5f, "unnormalized", 0, 0},
                    PbfCase{0.04f, 1.5f, "unnormalized", 0, 0}));

/// Mean of max(λ − 1, 0) after one step without gravity from a lattice squeezed to `squeeze` of its size.
double compressionAfterStep(Device& device, float spacing, const char* form, int iterations) {
  FluidScene scene(
      device, jitteredCube(10, 0.95f * spacing, 0, 1), {},
      object({{"spacing", spacing}, {"calibration", "lattice"}}),
      object({{"solver",
               object({{"type", "Pbf"}, {"params", object({{"form", form}, {"iterations", iterations}})}})},
              {"viscosity", disabled()}}));
  scene.gravity = {};
  scene.reset(1e-3);
  scene.step();
  return scene.report().statistics["compression"]["mean"].asDouble();
}

TEST(Pbf, TextbookDoesNotDependOnTheSpacingUnnormalizedDoes) {
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    const double fine = compressionAfterStep(*device, 0.005f, "textbook", 3);
    const double coarse = compressionAfterStep(*device, 0.04f, "textbook", 3);
    EXPECT_NEAR(fine, coarse, 1e-3 * fine) << name;
    // Eight times the spacing: the step of the unnormalized form is 512 times as long.
    const double fineUnnormalized = compressionAfterStep(*device, 0.005f, "unnormalized", 3);
    const double coarseUnnormalized = compressionAfterStep(*device, 0.04f, "unnormalized", 3);
    EXPECT_GT(fineUnnormalized, 2 * coarseUnnormalized) << name;
  }
}

TEST(Pbf, UnnormalizedIsTheTextbookWithItsStepTuned) {
  constexpr float kSpacing = 0.02f;
  const std::vector<Vec3f> positions = jitteredCube(8, kSpacing, 0.2f, 7);
  const auto device = openDevice("cpu");
  const auto after = [&](Value params) {
    FluidScene scene(*device, positions, {}, object({{"spacing", kSpacing}, {"calibration", "lattice"}}),
                     object({{"solver", object({{"type", "Pbf"}, {"params", std::move(params)}})},
                             {"viscosity", disabled()}}));
    scene.reset(1e-3);
    scene.step();
    std::vector<Vec3d> result;
    for (const Vec3f& p : scene.positions()) result.push_back(toDouble(p));
    return std::pair(scene.positions(), result);
  };
  // The relaxations, 0.1·V0² and epsilon/d², are both too small to matter.
  const double tuned = 1 / (1000 * std::pow(double(kSpacing), 3));
  const auto textbook = after(object({{"form", "textbook"}, {"epsilon", 1e-6}}));
  const auto unnormalized = after(object({{"form", "unnormalized"}, {"step", tuned}}));
  const auto longer = after(object({{"form", "unnormalized"}, {"step", 1.1 * tuned}}));
  EXPECT_LT(largestDifference(unnormalized.first, textbook.second) / kSpacing, 1e-4);
  EXPECT_GT(largestDifference(longer.first, textbook.second) / kSpacing, 1e-3);
}

TEST(Pbf, ConservesMomentum) {
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    const std::vector<Vec3f> positions = jitteredCube(12, 0.01f, 0.3f, 5);
    FluidScene scene(*device, positions, {}, object({}), object({{"solver", object({{"type", "Pbf"}})}}));
    scene.gravity = {};
    scene.reset(1e-3);
    scene.step();
    double scale = 0;
    for (const Vec3f& v : scene.velocities()) scale += length(toDouble(v));
    EXPECT_LT(length(sumOf(scene.velocities())), 1e-5 * scale) << name;
    EXPECT_GT(scale, 0);
  }
}

TEST(Pbf, CoincidentParticlesSeparate) {
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    FluidScene scene(*device, {{0, 0, 0}, {0, 0, 0}}, {}, object({{"spacing", 0.01}}),
                     object({{"solver", object({{"type", "Pbf"}})}}));
    scene.gravity = {};
    scene.reset(1e-3);
    scene.step(200);
    EXPECT_GT(length(scene.positions()[0] - scene.positions()[1]), 0.002f) << name;
  }
}

TEST(Pbf, RefusesParametersThatTheFormDoesNotHave) {
  Pbf module;
  for (const char* name : {"epsilon", "artificial_pressure"}) {
    const Error error = errorOf([&] {
      module.assignAll(object({{"form", "unnormalized"}, {name, 0.5}}), {"test", "", ""});
    });
    EXPECT_CONTAINS(error.what(), name);
    EXPECT_CONTAINS(error.what(), "textbook");
  }
  const Error error = errorOf([&] { Pbf().assignAll(object({{"step", 10}}), {"test", "", ""}); });
  EXPECT_CONTAINS(error.what(), "step");
  EXPECT_CONTAINS(error.what(), "unnormalized");
}

}  // namespace
}  // namespace weir::test
