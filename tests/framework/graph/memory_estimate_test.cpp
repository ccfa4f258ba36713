// What does not fit is refused with numbers, and what is proposed instead fits.
#include "framework/graph/memory_estimate.h"

#include <gtest/gtest.h>

#include "tests/support/expect_error.h"

namespace weir {
namespace {

constexpr double kGiB = double(1 << 30);

MemoryNeeds needs(double certain, double max, double particles) {
  MemoryNeeds of;
  of.certain = certain;
  of.device = max;
  of.particles = particles;
  of.remedy = [](double share) { return "a share of " + std::to_string(share); };
  return of;
}

TEST(MemoryEstimate, LetsPassWhatFitsOrCannotBeCompared) {
  MemoryEstimate estimate;
  estimate.add("water", needs(kGiB, kGiB, 1e6));
  EXPECT_EQ(estimate.check(kGiB, "cpu"), "");
  EXPECT_EQ(estimate.check(0, "cpu"), "") << "nobody knows what there is";
}

TEST(MemoryEstimate, RefusesWithWhatIsNeededWhatThereIsAndWhatFits) {
  MemoryEstimate estimate;
  MemoryNeeds grid;
  grid.add(kGiB);
  estimate.add("wall", grid);
  estimate.add("water", needs(4 * kGiB, 4 * kGiB, 8e6));
  const Error error = test::errorOf([&] { estimate.check(2 * kGiB, "cuda:0"); });
  EXPECT_EQ(error.kind(), ErrorKind::kScene);
  EXPECT_CONTAINS(error.what(), "5.0 GiB of memory on cuda:0");
  EXPECT_CONTAINS(error.what(), "4.0 GiB of them for 'water'");
  EXPECT_CONTAINS(error.what(), "8e+06 particles");
  EXPECT_CONTAINS(error.what(), "there are 2.0 GiB");
  // A tenth is left free, and 1 GiB is fixed: 0.8 GiB are for the 4.
  EXPECT_CONTAINS(error.allowed(), "a share of 0.2");
}

TEST(MemoryEstimate, OnlyWarnsOfWhatParticlesThatLeaveMayMakeRoomFor) {
  MemoryEstimate estimate;
  estimate.add("water", needs(kGiB, 100 * kGiB, 1e9));
  const std::string warning = estimate.check(10 * kGiB, "cpu");
  EXPECT_CONTAINS(warning, "up to 100 GiB");
  EXPECT_CONTAINS(warning, "a share of 0.09");
}

TEST(MemoryEstimate, SaysSomethingWhereNothingCanGiveWay) {
  MemoryEstimate estimate;
  MemoryNeeds grid;
  grid.add(3 * kGiB);
  estimate.add("wall", grid);
  EXPECT_FALSE(test::errorOf([&] { estimate.check(kGiB, "cpu"); }).allowed().empty());
}

TEST(MemoryEstimate, ChecksTheHostsMemoryByItself) {
  MemoryEstimate estimate;
  MemoryNeeds sampler;
  sampler.add(kGiB);
  sampler.host = 2 * kGiB;
  estimate.add("block", sampler);
  estimate.checkHost(2 * kGiB);
  EXPECT_CONTAINS(test::errorOf([&] { estimate.checkHost(kGiB); }).what(), "in the host");
}

TEST(ShortBytes, HasTwoDigitsOrMore) {
  EXPECT_EQ(shortBytes(0), "0 bytes");
  EXPECT_EQ(shortBytes(1023), "1023 bytes");
  EXPECT_EQ(shortBytes(3.44 * kGiB), "3.4 GiB");
  EXPECT_EQ(shortBytes(512.0 * 1024 * 1024), "512 MiB");
}

}  // namespace
}  // namespace weir
