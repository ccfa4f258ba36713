// The arithmetic of eight pixels at a time against that of the standard library.
#include "plugins/rendering/compute/pixel_lanes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace weir::rendering {
namespace {

TEST(PixelLanes, ExponentialsAndPowersAreThoseOfTheLibrary) {
  for (float x = -80; x <= 80; x += 0.37f) {
    const double wanted = std::exp(double{x});
    EXPECT_NEAR(laneOf(exponential(Number(x)), kPixels - 1) / wanted, 1, 1e-5) << x;  // 80 · 2^-24 in x
  }
  for (float x = 1e-6f; x < 1e6f; x *= 1.09f) {
    const double wanted = std::pow(double{x}, 1 / 2.4);
    EXPECT_NEAR(laneOf(power(Number(x), 1 / 2.4f), 0) / wanted, 1, 2e-6) << x;
  }
}

TEST(PixelLanes, WholeNumbersAndWhatIsBeyond) {
  for (float x = -40; x < 40; x += 0.25f) {
    Number beyond;
    const Ints whole = split(Number(x), beyond);
    EXPECT_EQ(static_cast<int>(laneOf(whole, 0)), static_cast<int>(std::floor(x))) << x;
    EXPECT_EQ(laneOf(beyond, 0), x - std::floor(x)) << x;
    EXPECT_EQ(static_cast<int>(laneOf(nearestInts(Number(x)), 0)), static_cast<int>(std::rint(x))) << x;
  }
}

TEST(PixelLanes, WhatIsLoadedTogetherIsWhatEachPixelSees) {
  float numbers[40];
  std::uint64_t wide[40];
  for (int i = 0; i < 40; ++i) {
    numbers[i] = 0.5f * static_cast<float>(i);
    wide[i] = (std::uint64_t{1000} + static_cast<std::uint64_t>(i)) << 32 |
              (0xfffffff0u + static_cast<unsigned>(i % 8));
  }
  const Ints at = clamped(intsFrom(-3) * 5, 2, 38);
  Number first, second;
  Ints lower, upper;
  gatherPairs(numbers, at, first, second);
  gatherHalves(wide, at, lower, upper);
  for (int l = 0; l < kPixels; ++l) {
    const int place = std::min(38, std::max(2, 5 * (l - 3)));
    EXPECT_EQ(static_cast<int>(laneOf(at, l)), place);
    EXPECT_EQ(laneOf(first, l), numbers[place]);
    EXPECT_EQ(laneOf(second, l), numbers[place + 1]);
    EXPECT_EQ(laneOf(lower, l), static_cast<std::uint32_t>(wide[place]));
    EXPECT_EQ(laneOf(upper, l), wide[place] >> 32);
    EXPECT_EQ(laneOf(gatherUpper(wide, at), l), wide[place] >> 32);
    for (const int start : {-4, 0, 9, 37})
      EXPECT_EQ(laneOf(rowFrom(numbers, start, 40), l), numbers[std::min(39, std::max(0, start + l))]);
  }
}

}  // namespace
}  // namespace weir::rendering
