#include "apps/studio/session/number_pace.h"

#include <gtest/gtest.h>

namespace weir::studio {
namespace {

using std::chrono::milliseconds;

class NumberPaceTest : public testing::Test {
 protected:
  /// Numbers that take so long.
  void make(int ms) { pace.made(at, at + milliseconds(ms)), at += milliseconds(ms); }
  bool isDueAfter(int ms) const { return pace.isDue(at + milliseconds(ms)); }

  NumberPace pace;
  NumberPace::Clock::time_point at{milliseconds(1'000'000)};
};

TEST_F(NumberPaceTest, IsFourTimesASecondWhereNumbersCostLittle) {
  EXPECT_TRUE(isDueAfter(0));
  make(1), make(1);
  EXPECT_FALSE(isDueAfter(249));
  EXPECT_TRUE(isDueAfter(250));
}

TEST_F(NumberPaceTest, NumbersTakeAHundredthOfTheTime) {
  make(20), make(30);
  EXPECT_FALSE(isDueAfter(1999));
  EXPECT_TRUE(isDueAfter(2000));
  make(40);
  EXPECT_FALSE(isDueAfter(2999));
}

TEST_F(NumberPaceTest, OneThatWasInterruptedDoesNotHoldUpTheNext) {
  make(80);
  EXPECT_TRUE(isDueAfter(250));
  make(1), make(80);
  EXPECT_TRUE(isDueAfter(250));
}

}  // namespace
}  // namespace weir::studio
