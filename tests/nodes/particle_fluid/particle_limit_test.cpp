// More than 2^31 particles are refused where a rank or what it gathers would be so many, and nowhere else.
#include "nodes/particle_fluid/particle_limit.h"

#include <gtest/gtest.h>

#include "tests/support/expect_error.h"

namespace weir::test {
namespace {

std::string remedy(double share) {
  return "times " + std::to_string(share);
}

TEST(ParticleLimit, IsThatOfEachRankAndNotOfAll) {
  EXPECT_NO_THROW(checkParticleCount({.all = 2147483647, .onRank = 2147483647}, remedy));
  EXPECT_NO_THROW(checkParticleCount({.all = 4e9, .onRank = 1.1e9, .ranks = 4}, remedy));
  const Error alone = errorOf([] { checkParticleCount({.all = 4e9, .onRank = 4e9}, remedy); });
  EXPECT_CONTAINS(alone.what(), "4e+09 particles");
  EXPECT_CONTAINS(alone.what(), "at most 2147483647");
  EXPECT_CONTAINS(alone.what(), "times 0.53");
  const Error two = errorOf([] { checkParticleCount({.all = 4.2e9, .onRank = 2.2e9, .ranks = 2}, remedy); });
  EXPECT_CONTAINS(two.what(), "each of 2 ranks up to 2.2e+09");
  EXPECT_CONTAINS(two.what(), "at most 2147483647 on a rank");
  EXPECT_CONTAINS(two.what(), "more ranks");
}

TEST(ParticleLimit, IsThatOfWhatTheFirstRankGathers) {
  const Error gathered = errorOf(
      [] { checkParticleCount({.all = 4e9, .onRank = 1.1e9, .ranks = 4, .gathered = true}, remedy); });
  EXPECT_CONTAINS(gathered.what(), "the first rank would gather");
  EXPECT_CONTAINS(gathered.what(), "times 0.53");
  EXPECT_NO_THROW(checkParticleCount({.all = 2e9, .onRank = 6e8, .ranks = 4, .gathered = true}, remedy));
}

TEST(ParticleLimit, IsThatOfExactSums) {
  EXPECT_CONTAINS(errorOf([] { checkParticleCount({.all = 5e9, .onRank = 7e8, .ranks = 8}, remedy); }).what(),
                  "at most 4294967296 of all ranks");
}

}  // namespace
}  // namespace weir::test
