#include "nodes/particle_fluid/fluid_warnings.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "framework/graph/setting_warning.h"

namespace weir {

void FluidOutlook::warn(const Module& module, const std::string& found, const std::string& better) const {
  warnOfSetting(log, fmt::format("node '{}', module '{}'", node, module.name()), found, better);
}

double hydrostaticPressure(const InitialFluid& fluid, const Vec3f& gravity, double restDensity) {
  if (fluid.box.empty()) return 0;
  const Vec3f size = fluid.box.hi - fluid.box.lo;
  // |g|·h, with h the extent of the box along g.
  const double weight = std::abs(double(gravity.x)) * size.x + std::abs(double(gravity.y)) * size.y +
                        std::abs(double(gravity.z)) * size.z;
  return restDensity * weight;
}

namespace {

void warnOfFall(const FluidOutlook& outlook, const std::string& where, double gravity) {
  // Fewer steps than this over the first spacing of a free fall, √(2d/g).
  constexpr double kMinSteps = 4;
  const double fall = std::sqrt(2 * outlook.constants.spacing / gravity);
  if (fall >= kMinSteps * outlook.dt * (1 - kSettingRounding)) return;
  warnOfSetting(outlook.log, where,
                fmt::format("a particle falls its first spacing in {:.3g} steps of {:.3g} s",
                            fall / outlook.dt, outlook.dt),
                fmt::format("a world.dt of at most {:.2g} s, or world.cfl", fall / kMinSteps));
}

void warnOfSpeed(const FluidOutlook& outlook, const std::string& where, double speed) {
  const double spacing = outlook.constants.spacing, travel = speed * outlook.dt / spacing;
  if (travel <= kMaxTravel * (1 + kSettingRounding)) return;
  warnOfSetting(outlook.log, where,
                fmt::format("particles start with up to {:.4g} m/s, {:.3g} spacings in a step of {:.3g} s",
                            speed, travel, outlook.dt),
                fmt::format("a world.dt of at most {:.2g} s, or world.cfl", kMaxTravel * spacing / speed));
}

void warnOfWeight(const FluidOutlook& outlook, const std::string& where) {
  constexpr double kNoticeable = 0.01;
  const double compression = outlook.pressure / outlook.constants.bulkModulus;
  if (compression <= kNoticeable * (1 + kSettingRounding)) return;
  warnOfSetting(outlook.log, where,
                fmt::format("its own weight, {:.3g} Pa at the bottom, compresses the fluid by {:.2g} % there",
                            outlook.pressure, 100 * compression),
                fmt::format("a bulk_modulus of at least {:.2g} Pa", outlook.pressure / kNoticeable));
}

void warnOfStiffness(const FluidOutlook& outlook, const std::string& where) {
  // λ is near 1, so it is told to the rounding of 1. Fluid whose weight is a few of these never comes to
  // rest.
  constexpr double kRoundings = 8, kLeast = kRoundings * std::numeric_limits<float>::epsilon();
  const FluidConstants& c = outlook.constants;
  const double compression = outlook.pressure / c.bulkModulus;
  if (compression == 0 || compression >= kLeast * (1 - kSettingRounding)) return;
  warnOfSetting(
      outlook.log, where,
      fmt::format("its own weight, {:.3g} Pa at the bottom, compresses the fluid by {:.2g} there, "
                  "which is lost in the rounding of single precision",
                  outlook.pressure, compression),
      fmt::format("a bulk_modulus of at most {:.2g} Pa", outlook.pressure / (kLeast * c.stiffened)));
}

}  // namespace

void warnOfFluid(const FluidOutlook& outlook, const InitialFluid& fluid, const SetupContext& context,
                 bool hasModulus) {
  const std::string where = fmt::format("node '{}'", outlook.node);
  if (!context.stepsVary) {
    warnOfFall(outlook, where, length(context.gravity));
    warnOfSpeed(outlook, where, fluid.speed);
  }
  if (!hasModulus) return;
  warnOfWeight(outlook, where);
  warnOfStiffness(outlook, where);
}

}  // namespace weir
