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
  constexpr double kMin = 1.2;  // below, K' would be so large that the rounding of λ made noise
  const double q = std::clamp(supportRatio, kMin, kFirstRatio + kRatioStep * (std::size(kPackingCurve) - 2));
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

/// Σ (1 − r/H)³ over the half of the cubic lattice whose first layer is one spacing away.
double halfLatticeSum(double supportRatio) {
  // The layer of the centre is the lattice of the plane; what is left lies on both sides.
  const int reach = static_cast<int>(std::ceil(supportRatio));
  double plane = 0;
  for (int x = -reach; x <= reach; ++x)
    for (int z = -reach; z <= reach; ++z) {
      const double q = std::sqrt(double(x * x + z * z)) / supportRatio;
      if (q < 1) plane += std::pow(1 - q, 3);
    }
  return 0.5 * (latticeSum(supportRatio) - plane);
}

/// a, such that water in tanks from 8 to 16 spacings wide stands as high as it should: what
/// `weir_packing_curve factor` finds.
double wallFactor(double supportRatio) {
  struct Point {
    double ratio, factor;
  };
  constexpr Point kMeasured[] = {{1.5, 1.09}, {2.0, 1.13}, {2.4, 1.07}};
  if (supportRatio <= kMeasured[0].ratio) return kMeasured[0].factor;
  for (std::size_t k = 1; k < std::size(kMeasured); ++k) {
    const Point a = kMeasured[k - 1], b = kMeasured[k];
    if (supportRatio < b.ratio)
      return a.factor + (b.factor - a.factor) * (supportRatio - a.ratio) / (b.ratio - a.ratio);
  }
  return std::end(kMeasured)[-1].factor;
}

}  // namespace

WallKernel wallKernel(double supportRatio, Calibration calibration) {
  double behind = ownDensity(supportRatio) * halfLatticeSum(supportRatio);
  if (calibration == Calibration::kPacking && supportRatio < kUsualRatio)
    behind *= std::min(1.0, settledShare(supportRatio) / settledShare(kUsualRatio));
  const auto halfSpace = [](double radius) {
    const double q = 0.5 / radius;
    return 0.5 * std::pow(1 - q, 5) * (1 + 2 * q);
  };
  double low = 0.5, high = supportRatio;  // it grows with the radius
  for (int k = 0; k < 50; ++k) {
    const double middle = 0.5 * (low + high);
    (halfSpace(middle) < behind ? low : high) = middle;
  }
  return {high, wallFactor(supportRatio)};
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
  c.contact = kContactRatio * spacing;
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
