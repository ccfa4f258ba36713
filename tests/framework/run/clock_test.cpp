#include "framework/run/clock.h"

#include <gtest/gtest.h>

#include "tests/support/expect_error.h"

namespace weir {
namespace {

TEST(Clock, FramesAreAtExactTimesAndStepsDivideThem) {
  const Clock clock(30, 0.001, 4);
  EXPECT_EQ(clock.frameCount(), 120);
  EXPECT_EQ(clock.stepsAfterFrame(0), 34);  // 33.3 steps of 1 ms would be needed
  EXPECT_DOUBLE_EQ(clock.dtAfterFrame(0), 1.0 / 30 / 34);
  EXPECT_FALSE(clock.hasRest());
  EXPECT_EQ(clock.totalSteps(), 120 * 34);
  for (int k = 0; k <= 120; ++k) EXPECT_EQ(clock.frameTime(k), k / 30.0);
}

TEST(Clock, AStepThatFitsIsKept) {
  EXPECT_EQ(Clock(50, 0.002, 1).stepsAfterFrame(0), 10);
  EXPECT_EQ(Clock(100, 0.01, 1).stepsAfterFrame(0), 1);
  EXPECT_EQ(Clock(100, 0.5, 1).stepsAfterFrame(0), 1);
}

TEST(Clock, TheRestAfterTheLastFrameIsSimulated) {
  const Clock clock(30, 0.001, 0.1 + 0.005);
  EXPECT_EQ(clock.frameCount(), 3);
  EXPECT_TRUE(clock.hasRest());
  const std::int64_t rest = clock.stepsAfterFrame(3);
  EXPECT_NEAR(static_cast<double>(rest) * clock.dtAfterFrame(3), 0.005, 1e-12);
  EXPECT_LE(clock.dtAfterFrame(3), 0.001 * (1 + 1e-12));
}

TEST(Clock, RoundingMakesNoExtraFrame) {
  // 0.1·3 is a little more than 0.3, and 1/3·30 a little less than 10.
  EXPECT_EQ(Clock(10, 0.001, 0.1 + 0.1 + 0.1).frameCount(), 3);
  EXPECT_FALSE(Clock(10, 0.001, 0.1 + 0.1 + 0.1).hasRest());
  EXPECT_EQ(Clock(30, 0.001, 1.0 / 3).frameCount(), 10);
  EXPECT_EQ(Clock(29.97, 0.001, 100 / 29.97).frameCount(), 100);
}

TEST(Clock, NoDurationIsFrameZeroAlone) {
  const Clock clock(30, 0.001, 0);
  EXPECT_EQ(clock.frameCount(), 0);
  EXPECT_EQ(clock.totalSteps(), 0);
}

TEST(Clock, RefusesStepsWithoutEnd) {
  EXPECT_EQ(test::errorOf([] { Clock(1, 1e-12, 10); }).kind(), ErrorKind::kScene);
}

}  // namespace
}  // namespace weir
