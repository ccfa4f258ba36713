// What walls need so that water keeps its volume: a small version of `weir_packing_curve offset` and
// `factor`.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "nodes/particle_fluid/fluid_constants.h"
#include "tools/calibration/resting_tanks.h"

namespace weir::test {
namespace {

TEST(WallOffset, IsFoundFromTheHeightsThatItMakes) {
  constexpr double kOffset = 0.03;
  std::vector<double> heights;
  // The room that is left between walls that are too far away, exactly.
  for (const Tank& tank : calibrationTanks()) {
    const double w = tank.width, h = tank.height, narrower = w - 2 * kOffset;
    heights.push_back((h * w * w / (narrower * narrower) + 2 * kOffset) / h);
  }
  EXPECT_NEAR(wallOffset(calibrationTanks(), heights), kOffset, 0.02 * kOffset);
}

/// The tables hold what the program finds, up to what fillings of two small tanks differ by from those of
/// all.
constexpr double kFillings = 0.03;

TEST(WallCalibration, SignedDistanceWallsLeaveWaterItsVolume) {
  CpuDevice device(0);
  const std::vector<Tank> tanks = {{8, 8}, {12, 12}};
  std::vector<double> heights;
  for (const Tank& tank : tanks) heights.push_back(RestingTank(device, tank, {.supportRatio = 2}).height());
  EXPECT_NEAR(wallOffset(tanks, heights), 0, kFillings);
}

TEST(WallCalibration, SemiAnalyticWallsLeaveWaterItsVolume) {
  CpuDevice device(0);
  const std::vector<Tank> tanks = {{8, 8}};
  const RestingTank tank(device, tanks[0], {.supportRatio = 2, .mesh = true});
  EXPECT_NEAR(wallOffset(tanks, {tank.height()}), 0, kFillings);
}

/// λ of a body-centred lattice with that many particles per d³.
double bodyCentredDensity(double number, double supportRatio) {
  const double cell = std::cbrt(2 / number);
  constexpr int kReach = 4;
  double sum = 0;
  for (int x = -kReach; x <= kReach; ++x)
    for (int y = -kReach; y <= kReach; ++y)
      for (int z = -kReach; z <= kReach; ++z)
        for (const double centre : {0.0, 0.5}) {
          const double r = cell * std::hypot(x + centre, y + centre, z + centre);
          if (r < supportRatio) sum += std::pow(1 - r / supportRatio, 3);
        }
  return packingCalibration(supportRatio) * 15 / (std::numbers::pi * std::pow(supportRatio, 3)) * sum;
}

/// Fluid that has ordered itself takes less volume than that without order, by which it is calibrated.
TEST(PackingCalibration, ABodyCentredCrystalTakesLessVolume) {
  EXPECT_LT(bodyCentredDensity(1, 1.5), 1);
  EXPECT_NEAR(bodyCentredDensity(1 / 0.983, 1.5), 1, 1e-3);
}

}  // namespace
}  // namespace weir::test
