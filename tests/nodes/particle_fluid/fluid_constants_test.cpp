// The numbers of a fluid, against relaxed tiles and closed forms.
#include "nodes/particle_fluid/fluid_constants.h"

#include <gtest/gtest.h>

#include <cmath>

#include "framework/compute/cpu_threads.h"
#include "nodes/particles/relaxed_tile.h"

namespace weir::test {
namespace {

class Response : public testing::TestWithParam<double> {};

/// Fluid with n particles per d³ is the tile of the support ratio q·n^⅓ made smaller.
TEST_P(Response, IsThatOfSqueezedTiles) {
  constexpr double kSqueeze = 1.12;  // of lengths, so that the noise of a small tile is little of the change
  const double q = GetParam(), root = std::sqrt(kSqueeze);
  CpuThreads threads(2);
  const double denser = RelaxedTile(q * root, 8, 300, 1, threads).meanSum(),
               thinner = RelaxedTile(q / root, 8, 300, 1, threads).meanSum();
  const double response = std::log(denser / thinner) / (3 * std::log(kSqueeze));
  EXPECT_NEAR(settledResponse(q), response, 0.05 * response + 0.005);
}

INSTANTIATE_TEST_SUITE_P(SupportRatios, Response, testing::Values(1.2, 1.5, 2.0, 2.4));

TEST(Stiffening, KeepsSmallSupportsAsStiffAsTheUsualOne) {
  const double usual = std::pow(settledResponse(1.5), 2);
  for (const double ratio : {1.2, 1.3, 1.4, 1.499})
    EXPECT_NEAR(stiffening(ratio, Calibration::kPacking) * std::pow(settledResponse(ratio), 2), usual, 1e-9);
  for (const double ratio : {1.5, 2.0, 2.4}) EXPECT_EQ(stiffening(ratio, Calibration::kPacking), 1);
  for (const double ratio : {1.2, 1.5, 2.0}) EXPECT_EQ(stiffening(ratio, Calibration::kLattice), 1);
  EXPECT_EQ(stiffening(1.1, Calibration::kPacking), stiffening(1.2, Calibration::kPacking));
}

/// Of a plane at d/2, in spacings and without s: Ψ = a·½(1 − q)⁵(1 + 2q) at q = d/2H_w, and its slope.
struct Felt {
  double value, slope;
};
Felt feltAtRest(double ratio, Calibration calibration) {
  const WallKernel wall = wallKernel(ratio, calibration);
  const double q = 0.5 / wall.radius;
  return {wall.factor * 0.5 * std::pow(1 - q, 5) * (1 + 2 * q),
          wall.factor * 1.5 * std::pow(1 - q, 4) * (1 + 4 * q) / wall.radius};
}

TEST(WallKernel, IsFeltLikeTheLatticeBehindAWall) {
  for (const double ratio : {1.1, 1.2, 1.5, 1.77, 2.0, 2.4, 3.0}) {
    const auto behind = [ratio](double x, double y, double z) {
      const double r = std::sqrt(x * x + y * y + z * z);
      return r < ratio ? 15 / (3.14159265358979 * std::pow(ratio, 3)) * std::pow(1 - r / ratio, 3) : 0;
    };
    double value = 0, slope = 0;
    for (int x = -3; x <= 3; ++x)
      for (int y = 1; y <= 3; ++y)
        for (int z = -3; z <= 3; ++z) {
          constexpr double kStep = 1e-5;
          value += behind(x, y, z);
          slope += (behind(x, y - kStep, z) - behind(x, y + kStep, z)) / (2 * kStep);
        }
    const Felt felt = feltAtRest(ratio, Calibration::kLattice);
    EXPECT_NEAR(felt.value, value, 1e-6 * value) << ratio;
    EXPECT_NEAR(felt.slope, 2 * slope, 1e-4 * slope) << ratio;
  }
}

TEST(WallKernel, IsFeltLessWhereSettledFluidAddsLessThanALattice) {
  const auto share = [](double ratio) {
    const double inLattice = 1 / latticeCalibration(ratio), settled = 1 / packingCalibration(ratio);
    const double own = 15 / (3.14159265358979 * ratio * ratio * ratio);
    return (settled - own) / (inLattice - own);
  };
  for (const double ratio : {1.2, 1.3, 1.45, 1.5, 2.0, 2.4}) {
    const Felt settled = feltAtRest(ratio, Calibration::kPacking),
               lattice = feltAtRest(ratio, Calibration::kLattice);
    const double less = ratio < 1.5 ? std::min(1.0, share(ratio) / share(1.5)) : 1;
    EXPECT_NEAR(settled.value / lattice.value, less, 1e-6) << ratio;
    EXPECT_NEAR(settled.slope / lattice.slope, less, 1e-6) << ratio;
  }
  EXPECT_LT(feltAtRest(1.2, Calibration::kPacking).value, 0.4 * feltAtRest(1.2, Calibration::kLattice).value);
}

}  // namespace
}  // namespace weir::test
