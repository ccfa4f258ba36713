// When iterations by conjugate gradients end: how much the last of them may lower the objective in calm water
// and in a splash.
#include "nodes/particle_fluid/modules/accelerated_judge.h"

#include <gtest/gtest.h>

#include <limits>

#include "nodes/particle_fluid/modules/conjugate_passes.h"

namespace weir::test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// Energies in units of what weight makes in a step.
constexpr detail::GainTolerance kInGravity{.bulk = 4, .weight = 1};

TEST(GainTolerance, IsAShareOfWhatWeightMakesWherePressureUndoesTheWeightOrLess) {
  EXPECT_DOUBLE_EQ(kInGravity.at(1), 0.1);
  EXPECT_DOUBLE_EQ(kInGravity.at(1.05), 0.1);  // particles of calm water differ a little
  EXPECT_DOUBLE_EQ(kInGravity.at(0), 0.1);     // falls freely
}

TEST(GainTolerance, GrowsWithThePressureOfASplashUpToThatOfTheTolerance) {
  EXPECT_GT(kInGravity.at(2), 2 * kInGravity.at(1));
  EXPECT_LT(kInGravity.at(2), kInGravity.at(6));
  EXPECT_LT(kInGravity.at(6), 4);
  EXPECT_EQ(kInGravity.at(1000), 4);
  EXPECT_EQ((detail::GainTolerance{.bulk = 0.05, .weight = 1}.at(1)), 0.05);
}

TEST(GainTolerance, IsThatOfTheToleranceWithoutGravity) {
  EXPECT_EQ((detail::GainTolerance{.bulk = 4, .weight = 0}.at(6)), 4);
}

TEST(GainTolerance, IsThatOfCalmWaterWhereDisplacementsAreNoNumbers) {
  EXPECT_DOUBLE_EQ(kInGravity.at(kNan), 0.1);
}

/// After an iteration of ten particles that has led from an objective of 100 to this one.
SolverControl judged(double objective, double displaced) {
  SolverControl control;
  control.iterations = 5;
  control.sinceRestart = 3;
  control.begun = 1;
  control.objective = 100;
  const SolverSums sums{.compression = 0.001, .objective = objective, .displaced = displaced};
  const detail::Judge judge{.control = &control,
                            .sums = &sums,
                            .count = 10,
                            .tolerance = 1e-3,
                            .gainTolerance = kInGravity,
                            .maxRepeats = 10,
                            .maxIterations = 1000,
                            .passes = 3};
  detail::JudgeState{judge}(0);
  return control;
}

TEST(JudgeState, EndsASplashWhereItGoesOnInCalmWater) {
  // 3 in all are 0.3 of each particle.
  EXPECT_FALSE(judged(97, 10).done);
  EXPECT_TRUE(judged(97, 60).done);
  EXPECT_FALSE(judged(50, 60).done);
  EXPECT_TRUE(judged(99.6, 10).done);
}

TEST(JudgeState, TakesBackWhatHasRisenOrIsNoNumber) {
  for (const double objective : {101.0, kNan, std::numeric_limits<double>::infinity()}) {
    const SolverControl control = judged(objective, 10);
    EXPECT_TRUE(control.takesBack) << objective;
    EXPECT_FALSE(control.met) << objective;
    EXPECT_EQ(control.objective, 100) << objective;
  }
  EXPECT_FALSE(judged(97, 10).takesBack);
}

}  // namespace
}  // namespace weir::test
