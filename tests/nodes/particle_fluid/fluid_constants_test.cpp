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

TEST(FluidConstants, KIsThatOfTheFluidAndMuThatOfAParticle) {
  for (const float ratio : {1.2f, 1.5f, 2.4f}) {
    FluidConstants c = makeFluidConstants(0.01f, ratio, 1000, 1e6f, Calibration::kLattice);
    EXPECT_EQ(c.stiffness, 1e6f);
    EXPECT_EQ(c.excessUnder(1e3), 1e-3);
    c = makeFluidConstants(0.01f, ratio, 1000, 1e6f, Calibration::kPacking);
    const double response = settledResponse(ratio);
    EXPECT_EQ(c.bulkModulus, 1e6f);
    EXPECT_NEAR(c.stiffness * response * response, 1e6, 1);
    EXPECT_NEAR(c.excessUnder(1e3), 1e-3 * response, 1e-9);
    c.setStiffness(2e6f);
    EXPECT_EQ(c.stiffness, 2e6f);
    EXPECT_NEAR(c.bulkModulus, 2e6 * response * response, 1);
  }
  EXPECT_EQ(settledResponse(1.1), settledResponse(1.2));
  EXPECT_LT(settledResponse(3), 1);
}

TEST(WallRadius, IsLessWhereSettledFluidAddsLessThanALattice) {
  // Φ of the plane at d/2, without s: ½(1 − q)⁵(1 + 2q) at q = d/2H_w.
  const auto phi = [](double ratio, Calibration calibration) {
    const double q = 0.5 / wallRadiusRatio(ratio, calibration);
    return 0.5 * std::pow(1 - q, 5) * (1 + 2 * q);
  };
  for (const double ratio : {1.2, 1.5, 2.0, 2.4}) {
    const double inLattice = 1 / latticeCalibration(ratio), settled = 1 / packingCalibration(ratio);
    const double own = 15 / (3.14159265358979 * ratio * ratio * ratio);
    EXPECT_NEAR(phi(ratio, Calibration::kPacking) / phi(ratio, Calibration::kLattice),
                (settled - own) / (inLattice - own), 1e-6)
        << ratio;
  }
  EXPECT_LT(phi(1.2, Calibration::kPacking), 0.4 * phi(1.2, Calibration::kLattice));
}

}  // namespace
}  // namespace weir::test
