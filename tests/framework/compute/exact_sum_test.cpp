// Sums that depend on no order: compared with long double, with themselves in other orders and parts.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "framework/compute/exact_sum.h"

namespace weir::test {
namespace {

bool same(const ExactSum& a, const ExactSum& b) {
  return a.ones == b.ones && a.fine == b.fine && a.finest == b.finest;
}

std::vector<double> terms() {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> mantissa(-1, 1), exponent(-40, 20);
  std::vector<double> all;
  for (int k = 0; k < 20000; ++k) all.push_back(std::ldexp(mantissa(random), int(exponent(random))));
  return all;
}

TEST(ExactSum, IsTheSumToTheLastBitsThatATermIsReadTo) {
  long double expected = 0;
  ExactSum sum;
  for (const double term : terms()) expected += term, sum += ExactSum(term);
  EXPECT_NEAR(sum.value(), double(expected), 1e-9);
  EXPECT_EQ(ExactSum(0.1).value(), 0.1);
  EXPECT_EQ(ExactSum(-0.1).value(), -0.1);
  EXPECT_EQ(ExactSum(123456.789).value(), 123456.789);
  EXPECT_NEAR(ExactSum(1e-12).value(), 1e-12, std::ldexp(1, -62));
}

TEST(ExactSum, HasTheSameBitsInEveryOrderAndInAnyParts) {
  std::vector<double> all = terms();
  const auto sumOf = [](auto begin, auto end) {
    ExactSum sum;
    for (; begin != end; ++begin) sum += ExactSum(*begin);
    return sum;
  };
  const ExactSum whole = sumOf(all.begin(), all.end());
  std::mt19937 random(2);
  for (int round = 0; round < 10; ++round) {
    std::shuffle(all.begin(), all.end(), random);
    const auto cut = all.begin() + std::ptrdiff_t(random() % all.size());
    EXPECT_TRUE(same(sumOf(all.begin(), cut) + sumOf(cut, all.end()), whole));
  }
}

TEST(ExactSum, NaNCountsAsNothingAndWhatIsTooLargeAsTheBound) {
  EXPECT_TRUE(same(ExactSum(std::numeric_limits<double>::quiet_NaN()), ExactSum()));
  EXPECT_EQ(ExactSum(std::numeric_limits<double>::infinity()).value(), 2147483647.0);
  EXPECT_EQ(ExactSum(-1e300).value(), -2147483647.0);
}

/// As many as ranks may have together (particle_limit.h).
TEST(ExactSum, HasRoomFor4294967296TermsWhateverTheyAre) {
  constexpr int kDoublings = 32;
  const double below1 = std::nextafter(1.0, 0.0), belowFine = std::ldexp(below1, -31);
  for (const double term : {below1, -below1, belowFine, 1073741823.5, -1073741823.5}) {
    ExactSum sum(term);
    for (int k = 0; k < kDoublings; ++k) sum += ExactSum(sum);
    EXPECT_EQ(sum.value(), std::ldexp(ExactSum(term).value(), kDoublings)) << term;
  }
}

/// Of each kind one, and another that is scaled.
struct Numbers {
  double share = 0, square = 0, farthest = 0, slope = 0;
  WEIR_HD static constexpr SumKind kindOf(int k) {
    return k == 0 ? SumKind::kNumber : k == 2 ? SumKind::kMax : SumKind::kScaled;
  }
};

TEST(ExactSums, KeepTermsThatAreSmallAgainstOneAndTakeTheLargestWhereThatIsAsked) {
  constexpr double kSmall = 1e-24;
  const double unit = powerBelow(kSmall);
  ExactSums<Numbers> first, second;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> some(-1, 1);
  long double square = 0, slope = 0, share = 0;
  double farthest = 0;
  for (int k = 0; k < 1000; ++k) {
    const Numbers term{some(random), kSmall * some(random), std::abs(some(random)), kSmall * some(random)};
    share += term.share, square += term.square, slope += term.slope;
    farthest = std::max(farthest, term.farthest);
    (k % 3 == 0 ? first : second) += ExactSums<Numbers>(term, 1 / unit);
  }
  const Numbers all = (first + second).value(unit), turned = (second + first).value(unit);
  EXPECT_NEAR(all.share, double(share), 1e-12);
  EXPECT_NEAR(all.square, double(square), 1e-12 * kSmall);
  EXPECT_NEAR(all.slope, double(slope), 1e-12 * kSmall);
  EXPECT_EQ(all.farthest, farthest);
  EXPECT_EQ(all.square, turned.square);
}

TEST(ExactSums, TheUnitIsOfTheLargestFiniteNumber) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(largestNumber(Numbers{1, -3, 2, kInfinity}), 3);
  EXPECT_EQ(largestNumber(Numbers{0, std::numeric_limits<double>::quiet_NaN(), 0, 0}), 0);
  EXPECT_EQ(powerBelow(3), 2);
  EXPECT_EQ(powerBelow(0.3), 0.25);
}

}  // namespace
}  // namespace weir::test
