#include "plugins/rendering/overlay/ticks.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace weir::rendering {
namespace {

std::vector<std::string> labels(double lowest, double highest) {
  std::vector<std::string> texts;
  for (const Tick& tick : roundTicks(lowest, highest, 5)) texts.push_back(tick.label);
  return texts;
}

TEST(Ticks, AreWrittenAsAPersonWould) {
  using Texts = std::vector<std::string>;
  EXPECT_EQ(labels(0, 5), (Texts{"0", "1", "2", "3", "4", "5"}));
  EXPECT_EQ(labels(0, 1), (Texts{"0.0", "0.2", "0.4", "0.6", "0.8", "1.0"}));
  EXPECT_EQ(labels(-1.1, 1.1), (Texts{"-1.0", "-0.5", "0.0", "0.5", "1.0"}));
  EXPECT_EQ(labels(993, 1012), (Texts{"995", "1000", "1005", "1010"}));
  EXPECT_EQ(labels(0, 0.043), (Texts{"0.00", "0.01", "0.02", "0.03", "0.04"}));
  EXPECT_EQ(labels(0, 4e7), (Texts{"0", "1e+07", "2e+07", "3e+07", "4e+07"}));
}

TEST(Ticks, AreRoundAndInsideForAnyRange) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> exponent(-8, 8), any(-1, 1);
  for (int i = 0; i < 2000; ++i) {
    const double scale = std::pow(10, exponent(random)), a = scale * any(random);
    const double b = a + scale * (0.01 + std::abs(any(random)));
    const auto ticks = roundTicks(a, b, 5);
    ASSERT_GE(ticks.size(), 2u) << a << " " << b;
    ASSERT_LE(ticks.size(), 10u) << a << " " << b;
    const double step = ticks[1].value - ticks[0].value;
    const double leading = step / std::pow(10, std::floor(std::log10(step) + 1e-6));
    EXPECT_LT(std::min({std::abs(leading - 1), std::abs(leading - 2), std::abs(leading - 5)}), 1e-6);
    for (const Tick& tick : ticks) {
      EXPECT_GE(tick.value, a - 1e-5 * (b - a));
      EXPECT_LE(tick.value, b + 1e-5 * (b - a));
      EXPECT_NEAR(std::stod(tick.label), tick.value, 0.01 * step) << tick.label;
    }
  }
}

TEST(Ticks, RangesWithoutWidthHaveOneOrNone) {
  EXPECT_EQ(labels(3.25, 3.25), (std::vector<std::string>{"3.25"}));
  EXPECT_EQ(labels(2, 1), (std::vector<std::string>{"2"}));
  EXPECT_EQ(labels(2, std::numeric_limits<double>::infinity()), (std::vector<std::string>{"2"}));
  EXPECT_TRUE(labels(std::nan(""), 1).empty());
  EXPECT_EQ(labels(1, 1 + 1e-15).size(), 1u);
}

TEST(Ticks, CountsHaveCommas) {
  EXPECT_EQ(particleText(0), "0 particles");
  EXPECT_EQ(particleText(1), "1 particle");
  EXPECT_EQ(particleText(999), "999 particles");
  EXPECT_EQ(particleText(28934), "28,934 particles");
  EXPECT_EQ(particleText(1234567), "1,234,567 particles");
  EXPECT_EQ(timeText(1.2334), "t = 1.233 s");
}

}  // namespace
}  // namespace weir::rendering
