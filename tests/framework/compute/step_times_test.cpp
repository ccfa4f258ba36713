// Times of steps: sums over all of them, and a bounded number that is kept.
#include "framework/compute/step_times.h"

#include <gtest/gtest.h>

namespace weir {
namespace {

TEST(StepTimes, KeepAllOfFewSteps) {
  StepTimes times;
  for (const double ms : {3.0, 1.0, 2.0}) times.add(ms);
  EXPECT_EQ(times.kept(), (std::vector<double>{3, 1, 2}));
  EXPECT_EQ(times.mean(), 2);
  times.clear();
  EXPECT_TRUE(times.kept().empty());
  EXPECT_EQ(times.count(), 0);
  EXPECT_EQ(times.mean(), 0);
}

TEST(StepTimes, KeepABoundedNumberOfManyStepsEvenlySpread) {
  StepTimes times;
  constexpr auto kSteps = static_cast<std::int64_t>(10 * StepTimes::kMost + 7);
  for (std::int64_t k = 0; k < kSteps; ++k) times.add(static_cast<double>(k));
  EXPECT_EQ(times.count(), kSteps);
  EXPECT_EQ(times.max(), static_cast<double>(kSteps - 1)) << "also of steps that are not kept";
  EXPECT_DOUBLE_EQ(times.mean(), static_cast<double>(kSteps - 1) / 2);
  ASSERT_LE(times.kept().size(), StepTimes::kMost);
  ASSERT_GT(times.kept().size(), StepTimes::kMost / 2);
  for (std::size_t k = 0; k < times.kept().size(); ++k)
    ASSERT_EQ(times.kept()[k], 16.0 * static_cast<double>(k));
  EXPECT_GT(times.kept().back(), static_cast<double>(kSteps) - 17);
}

}  // namespace
}  // namespace weir
