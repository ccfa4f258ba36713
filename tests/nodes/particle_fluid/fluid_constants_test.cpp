// The numbers of a fluid, against relaxed tiles and closed forms.
#include "nodes/particle_fluid/fluid_constants.h"

#include <gtest/gtest.h>

#include <cmath>

#include "framework/compute/cpu_threads.h"
#include "framework/particles/relaxed_tile.h"

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

TEST(PackingCalibration, GivesRelaxedTilesRestDensity) {
  for (const double ratio : {1.2, 1.5, 2.0, 2.4}) {
    CpuThreads threads(2);
    const double packing = packingCalibration(ratio);
    EXPECT_NEAR(packing / calibrationOf(RelaxedTile(ratio, 8, 200, 1, threads), ratio), 1, 0.004) << ratio;
    EXPECT_GT(latticeCalibration(ratio) * 1.04, packing) << ratio;
  }
}

TEST(Stiffening, KeepsSmallSupportsAsStiffAsTheUsualOne) {
  const double usual = std::pow(settledResponse(1.5), 2);
  for (const double ratio : {1.2, 1.3, 1.4, 1.499})
    EXPECT_NEAR(stiffening(ratio, Calibration::kPacking) * std::pow(settledResponse(ratio), 2), usual, 1e-9);
  for (const double ratio : {1.5, 2.0, 2.4}) EXPECT_EQ(stiffening(ratio, Calibration::kPacking), 1);
  for (const double ratio : {1.2, 1.5, 2.0}) EXPECT_EQ(stiffening(ratio, Calibration::kLattice), 1);
  EXPECT_EQ(stiffening(1.1, Calibration::kPacking), stiffening(1.2, Calibration::kPacking));
}

TEST(WallKernel, HasASmallerRadiusWhereSettledFluidAddsLessThanALattice) {
  // Φ of the plane at d/2, without s: ½(1 − q)⁵(1 + 2q) at q = d/2H_w.
  const auto phi = [](double ratio, Calibration calibration) {
    const double q = 0.5 / wallKernel(ratio, calibration).radius;
    return 0.5 * std::pow(1 - q, 5) * (1 + 2 * q);
  };
  const auto share = [](double ratio) {
    const double inLattice = 1 / latticeCalibration(ratio), settled = 1 / packingCalibration(ratio);
    const double own = 15 / (3.14159265358979 * ratio * ratio * ratio);
    return (settled - own) / (inLattice - own);
  };
  for (const double ratio : {1.2, 1.3, 1.45, 1.5, 2.0, 2.4})
    EXPECT_NEAR(phi(ratio, Calibration::kPacking) / phi(ratio, Calibration::kLattice),
                ratio < 1.5 ? std::min(1.0, share(ratio) / share(1.5)) : 1, 1e-6)
        << ratio;
  EXPECT_LT(phi(1.2, Calibration::kPacking), 0.4 * phi(1.2, Calibration::kLattice));
}

/// Between the two that continuous fluid asks for: 1 makes λ what it is in the bulk, 2 the pressure.
TEST(WallKernel, FactorIsContinuousAndBetweenThoseOfContinuousFluid) {
  double last = wallKernel(1.1, Calibration::kPacking).factor;
  for (double ratio = 1.11; ratio < 3; ratio += 0.01) {
    const double factor = wallKernel(ratio, Calibration::kPacking).factor;
    EXPECT_NEAR(factor, last, 0.01) << ratio;
    EXPECT_GT(factor, 1) << ratio;
    EXPECT_LT(factor, 2) << ratio;
    last = factor;
  }
}

}  // namespace
}  // namespace weir::test
