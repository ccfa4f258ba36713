#include "apps/studio/session/busy_share.h"

#include <gtest/gtest.h>

namespace weir::studio {
namespace {

using std::chrono::milliseconds;

TEST(BusyShare, IsOfTheLastSecond) {
  BusyShare busy;
  const BusyShare::Time start{};
  EXPECT_EQ(busy.share(), 0);
  busy.take(start, 5);
  EXPECT_EQ(busy.share(), 0);
  busy.take(start + milliseconds(500), 5.1);
  EXPECT_NEAR(busy.share(), 0.2, 1e-12);
  busy.take(start + milliseconds(1000), 5.6);
  EXPECT_NEAR(busy.share(), 0.6, 1e-12);
  busy.take(start + milliseconds(1500), 6.1);
  EXPECT_NEAR(busy.share(), 1, 1e-12);  // what was before half a second no longer counts
  busy.take(start + milliseconds(9500), 6.3);
  EXPECT_NEAR(busy.share(), 0.2 / 8, 1e-12);  // nothing is told while it pauses
}

TEST(BusyShare, BeginsAnewWithAnotherRun) {
  BusyShare busy;
  const BusyShare::Time start{};
  busy.take(start, 7);
  busy.take(start + milliseconds(100), 7.1);
  busy.take(start + milliseconds(200), 0);
  EXPECT_EQ(busy.share(), 0);
  busy.take(start + milliseconds(400), 0.1);
  EXPECT_NEAR(busy.share(), 0.5, 1e-12);
}

}  // namespace
}  // namespace weir::studio
