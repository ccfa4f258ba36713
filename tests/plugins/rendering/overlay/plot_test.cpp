#include "plugins/rendering/overlay/plot.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/child_process.h"

namespace weir::rendering {
namespace {

/// The middles of the blue pixels in each column; -1 where there are none.
class PlotTest : public testing::Test {
 protected:
  static constexpr int kWidth = 1280, kHeight = 720;
  Font font{test::buildFolder() + "/share/weir/fonts/DejaVuSans.ttf"};

  std::vector<double> curveOf(const Plot& plot, int place = 0) {
    Picture picture{kWidth, kHeight, std::vector<std::uint8_t>(3 * kWidth * kHeight, 200)};
    Pen pen(picture, false);
    drawPlot(pen, font, plot, place);
    std::vector<double> rows;
    for (int x = 0; x < kWidth; ++x) {
      double sum = 0, count = 0;
      for (int y = 0; y < kHeight; ++y) {
        const std::uint8_t* pixel = &picture.rgb[std::size_t(3) * (std::size_t(y) * kWidth + std::size_t(x))];
        if (pixel[2] < pixel[0] + 100) continue;
        sum += y, count += 1;
      }
      rows.push_back(count > 0 ? sum / count : -1);
    }
    return rows;
  }

  static int firstOf(const std::vector<double>& rows) {
    int x = 0;
    while (x < kWidth && rows[std::size_t(x)] < 0) ++x;
    return x;
  }
  static int lastOf(const std::vector<double>& rows) {
    int x = kWidth - 1;
    while (x >= 0 && rows[std::size_t(x)] < 0) --x;
    return x;
  }
};

TEST_F(PlotTest, AStraightCourseIsAStraightLine) {
  const std::vector<double> rows =
      curveOf({.caption = "way in m", .points = {{0, 0}, {1, 2}, {3, 6}}, .lastTime = 3});
  const int first = firstOf(rows), last = lastOf(rows);
  ASSERT_GT(last - first, 200);
  EXPECT_LT(last, kWidth / 2);
  const double low = rows[std::size_t(first)], high = rows[std::size_t(last)];
  EXPECT_GT(low, high + 80) << "upwards";
  for (int x = first; x <= last; ++x)
    EXPECT_NEAR(rows[std::size_t(x)], low + (high - low) * (x - first) / (last - first), 3) << x;
}

TEST_F(PlotTest, ARunThatGoesOnLeavesRoomAtTheRight) {
  const std::vector<double> whole = curveOf({.caption = "", .points = {{0, 1}, {2, 1.5}}, .lastTime = 2});
  const std::vector<double> half = curveOf({.caption = "", .points = {{0, 1}, {2, 1.5}}, .lastTime = 4});
  const int first = firstOf(whole);
  EXPECT_EQ(firstOf(half), first);
  EXPECT_NEAR(2 * (lastOf(half) - first), lastOf(whole) - first, 8);
}

TEST_F(PlotTest, NumbersThatAreNoneLeaveGaps) {
  const double none = std::nan("");
  const std::vector<double> rows =
      curveOf({.caption = "", .points = {{0, 1}, {1, 1.2}, {1.5, none}, {3, 1.2}, {4, 1}}, .lastTime = 4});
  const int first = firstOf(rows), last = lastOf(rows);
  EXPECT_LT(rows[std::size_t((first + last) / 2)], 0);
  EXPECT_GT(rows[std::size_t(first + (last - first) / 8)], 0);
  EXPECT_EQ(firstOf(curveOf({.caption = "", .points = {{0, none}}, .lastTime = 4})), kWidth);
}

TEST_F(PlotTest, OnesWithoutAChangeAndWithoutPointsAreDrawnToo) {
  const std::vector<double> flat = curveOf({.caption = "", .points = {{0, 1e9}, {1, 1e9}}, .lastTime = 1});
  EXPECT_NEAR(flat[std::size_t(firstOf(flat))], flat[std::size_t(lastOf(flat) - 20)], 1);
  EXPECT_EQ(firstOf(curveOf({.caption = "", .points = {}, .lastTime = 0})), kWidth);
}

TEST_F(PlotTest, TheNextOneStandsBeside) {
  const Plot plot{.caption = "", .points = {{0, 0}, {1, 2}}, .lastTime = 1};
  EXPECT_GT(firstOf(curveOf(plot, 1)), lastOf(curveOf(plot, 0)));
}

}  // namespace
}  // namespace weir::rendering
