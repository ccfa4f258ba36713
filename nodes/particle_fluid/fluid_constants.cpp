#include "nodes/particle_fluid/fluid_constants.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

namespace weir {

double latticeCalibration(double supportRatio) {
  // In units of the spacing; W₁ is the kernel with s = 1.
  const int reach = static_cast<int>(std::ceil(supportRatio));
  double sum = 0;
  for (int x = -reach; x <= reach; ++x)
    for (int y = -reach; y <= reach; ++y)
      for (int z = -reach; z <= reach; ++z) {
        const double q = std::sqrt(double(x * x + y * y + z * z)) / supportRatio;
        if (q < 1) sum += std::pow(1 - q, 3);
      }
  return std::numbers::pi * std::pow(supportRatio, 3) / (15 * sum);
}

namespace {

/// Ratio of the packing to the lattice calibration, measured by letting columns settle.
struct PackingPoint {
  double supportRatio, factor;
};
constexpr PackingPoint kPackingCurve[] = {
    {1.1, 1.020}, {1.2, 1.023}, {1.5, 1.030}, {2.0, 1.045}, {3.0, 1.045}};

}  // namespace

double packingCalibration(double supportRatio) {
  const auto after =
      std::upper_bound(std::begin(kPackingCurve), std::end(kPackingCurve), supportRatio,
                       [](double ratio, const PackingPoint& p) { return ratio < p.supportRatio; });
  double factor;
  if (after == std::begin(kPackingCurve)) {
    factor = after->factor;
  } else if (after == std::end(kPackingCurve)) {
    factor = std::prev(after)->factor;
  } else {
    const PackingPoint& a = *std::prev(after);
    const double t = (supportRatio - a.supportRatio) / (after->supportRatio - a.supportRatio);
    factor = a.factor + t * (after->factor - a.factor);
  }
  return latticeCalibration(supportRatio) * factor;
}

double wallRadiusRatio(double supportRatio) {
  // In units of the spacing, with s = 1: the half of the lattice whose first layer is one spacing away.
  const int reach = static_cast<int>(std::ceil(supportRatio));
  double behind = 0;
  for (int x = -reach; x <= reach; ++x)
    for (int y = -reach; y <= -1; ++y)
      for (int z = -reach; z <= reach; ++z) {
        const double q = std::sqrt(double(x * x + y * y + z * z)) / supportRatio;
        if (q < 1) behind += 15 / (std::numbers::pi * std::pow(supportRatio, 3)) * std::pow(1 - q, 3);
      }
  const auto halfSpace = [](double radius) {
    const double q = 0.5 / radius;
    return 0.5 * std::pow(1 - q, 5) * (1 + 2 * q);
  };
  double low = 0.5, high = supportRatio;  // it grows with the radius
  for (int k = 0; k < 50; ++k) {
    const double middle = 0.5 * (low + high);
    (halfSpace(middle) < behind ? low : high) = middle;
  }
  return high;
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
  c.wallRadius = static_cast<float>(wallRadiusRatio(supportRatio)) * spacing;
  c.restDensity = restDensity;
  c.particleVolume = spacing * spacing * spacing;
  c.particleMass = restDensity * c.particleVolume;
  c.bulkModulus = bulkModulus;
  c.calibration = static_cast<float>(calibration == Calibration::kLattice ? latticeCalibration(supportRatio)
                                                                          : packingCalibration(supportRatio));
  c.kernel = SpikyKernel(c.supportRadius, c.calibration);
  return c;
}

}  // namespace weir
