#include "nodes/particle_fluid/fluid_constants.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

namespace weir {

namespace {

/// Σ (1 − r/H)³ over the nodes of the cubic lattice, the centre included; spacings.
double latticeSum(double supportRatio) {
  const int reach = static_cast<int>(std::ceil(supportRatio));
  double sum = 0;
  for (int x = -reach; x <= reach; ++x)
    for (int y = -reach; y <= reach; ++y)
      for (int z = -reach; z <= reach; ++z) {
        const double q = std::sqrt(double(x * x + y * y + z * z)) / supportRatio;
        if (q < 1) sum += std::pow(1 - q, 3);
      }
  return sum;
}

/// V0·W(0) with s = 1, in spacings.
double ownDensity(double supportRatio) {
  return 15 / (std::numbers::pi * std::pow(supportRatio, 3));
}

}  // namespace

double latticeCalibration(double supportRatio) {
  return 1 / (ownDensity(supportRatio) * latticeSum(supportRatio));
}

namespace {

/// Ratio of the packing to the lattice calibration at support ratios of 1.1, 1.15, … 3. It waves because the
/// shells of the lattice enter the support one after another; `weir_packing_curve table` prints it.
constexpr double kFirstRatio = 1.1, kRatioStep = 0.05;
constexpr double kPackingCurve[] = {
    1.0041, 1.0108, 1.0192, 1.0273, 1.0333, 1.0360, 1.0350, 1.0305, 1.0235, 1.0166, 1.0103, 1.0054, 1.0019,
    0.9996, 0.9984, 0.9981, 0.9986, 1.0000, 1.0017, 1.0035, 1.0054, 1.0070, 1.0080, 1.0082, 1.0078, 1.0069,
    1.0057, 1.0044, 1.0029, 1.0017, 1.0007, 1.0001, 0.9999, 0.9999, 1.0001, 1.0004, 1.0008, 1.0011, 1.0014};

}  // namespace

double packingCalibration(double supportRatio) {
  constexpr int kLast = static_cast<int>(std::size(kPackingCurve)) - 1;
  const double at = std::clamp((supportRatio - kFirstRatio) / kRatioStep, 0.0, double(kLast));
  const int below = std::min(static_cast<int>(at), kLast - 1);
  const double t = at - below;
  return latticeCalibration(supportRatio) * ((1 - t) * kPackingCurve[below] + t * kPackingCurve[below + 1]);
}

double settledResponse(double supportRatio) {
  constexpr double kLeast = 1.2;  // below, K' would be so large that the rounding of λ made noise
  const double q =
      std::clamp(supportRatio, kLeast, kFirstRatio + kRatioStep * (std::size(kPackingCurve) - 2));
  const double low = q - kRatioStep, high = q + kRatioStep;
  return 1 - std::log(packingCalibration(high) / packingCalibration(low)) / (3 * std::log(high / low));
}

namespace {

/// Fluids of smaller supports are treated as this one, where walls and stiffness need no more.
constexpr double kUsualRatio = 1.5;

/// What the neighbours in settled fluid add, as a share of what those in a lattice add.
double settledShare(double supportRatio) {
  const double settled = 1 / (ownDensity(supportRatio) * packingCalibration(supportRatio)) - 1;
  return settled / (latticeSum(supportRatio) - 1);
}

}  // namespace

double stiffening(double supportRatio, Calibration calibration) {
  if (calibration == Calibration::kLattice || supportRatio >= kUsualRatio) return 1;
  return std::pow(settledResponse(kUsualRatio) / settledResponse(supportRatio), 2);
}

namespace {

/// What the half of the lattice adds whose first layer is one spacing below a particle, with s = 1: V0·ΣW,
/// and its gradient upwards, per spacing.
struct HalfLattice {
  double value = 0, slope = 0;
};

HalfLattice halfLattice(double supportRatio) {
  const int reach = static_cast<int>(std::ceil(supportRatio));
  const double own = ownDensity(supportRatio);
  HalfLattice sum;
  for (int x = -reach; x <= reach; ++x)
    for (int y = 1; y <= reach; ++y)
      for (int z = -reach; z <= reach; ++z) {
        const double r = std::sqrt(double(x * x + y * y + z * z)), t = 1 - r / supportRatio;
        if (t <= 0) continue;
        sum.value += own * t * t * t;
        sum.slope += 3 * own * t * t / supportRatio * y / r;
      }
  return sum;
}

}  // namespace

WallKernel wallKernel(double supportRatio, Calibration calibration) {
  constexpr double kDistance = 0.5;
  const HalfLattice behind = halfLattice(supportRatio);
  const double wanted = 2 * behind.slope / behind.value;
  double low = kDistance, high = 2 * supportRatio;  // the larger the radius, the flatter
  for (int k = 0; k < 50; ++k) {
    const double middle = 0.5 * (low + high), q = kDistance / middle;
    (3 * (1 + 4 * q) / (middle * (1 - q) * (1 + 2 * q)) > wanted ? low : high) = middle;
  }
  const double q = kDistance / high;
  double factor = behind.value / (0.5 * std::pow(1 - q, 5) * (1 + 2 * q));
  if (calibration == Calibration::kPacking && supportRatio < kUsualRatio)
    factor *= std::min(1.0, settledShare(supportRatio) / settledShare(kUsualRatio));
  return {high, factor};
}

int neighborCapacity(double supportRatio) {
  // Particles in the support ball at rest density, half as many again for compression, and a margin for the
  // small balls, where single particles count.
  constexpr double kDenser = 1.6;
  constexpr double kMargin = 16;
  const double inBall = 4.0 / 3.0 * std::numbers::pi * std::pow(supportRatio, 3);
  return static_cast<int>(std::ceil((kDenser * inBall + kMargin) / 8)) * 8;
}

FluidConstants makeFluidConstants(float spacing, float supportRatio, float restDensity, float bulkModulus,
                                  Calibration calibration) {
  FluidConstants c;
  c.spacing = spacing;
  c.supportRadius = supportRatio * spacing;
  const WallKernel wall = wallKernel(supportRatio, calibration);
  c.wallRadius = static_cast<float>(wall.radius) * spacing;
  c.restDensity = restDensity;
  c.particleVolume = spacing * spacing * spacing;
  c.particleMass = restDensity * c.particleVolume;
  c.bulkModulus = bulkModulus;
  c.calibration = static_cast<float>(calibration == Calibration::kLattice ? latticeCalibration(supportRatio)
                                                                          : packingCalibration(supportRatio));
  c.wallFactor = static_cast<float>(wall.factor) * c.calibration;
  c.kernel = SpikyKernel(c.supportRadius, c.calibration);
  return c;
}

}  // namespace weir
