#include "nodes/particle_fluid/auto_bulk_modulus.h"

#include <algorithm>
#include <cmath>

namespace weir {

namespace {

/// To one digit, but for what rounding may have added.
double roundedUp(double number) {
  constexpr double kRounding = 1 - 1e-3;
  const double decade = std::pow(10, std::floor(std::log10(number)));
  return std::ceil(kRounding * number / decade) * decade;
}

}  // namespace

double bulkModulusFor(double pressure, double tolerance) {
  constexpr double kMin = 1e6, kMax = 1e9;
  return roundedUp(std::min(std::max(kMin, pressure / tolerance), kMax));
}

}  // namespace weir
