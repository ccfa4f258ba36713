#include "nodes/particle_fluid/modules/capillary_force.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "framework/graph/setting_warning.h"

namespace weir {

SurfaceFit surfaceFit(double supportRatio) {
  // Measured at 2 and 2.5.
  const double beyond = std::clamp(supportRatio, 1.5, 3.0) - 2;
  return {.depth = 1.03 + 2.42 * beyond, .area = 0.891 + 0.108 * beyond};
}

void CapillaryForce::reset(FluidStep& fluid) {
  constexpr float kMinSupport = 2;  // spacings
  constexpr float kRounding = 1e-3f;
  const float support = fluid.constants.supportRadius / fluid.constants.spacing;
  if (enabled() && tension > 0 && support < kMinSupport - kRounding)
    fluid.time.log.warn(fmt::format(
        "module '{}': surface tension needs a support_ratio of at least {}; {:.4g} is too little to see how "
        "the surface is bent",
        name(), kMinSupport, support));
}

void CapillaryForce::warn(const FluidOutlook& outlook) const {
  // That of waves which are two spacings long; drops of 6 d fly apart at 0.8 (engineering/method.md).
  constexpr double kMax = 0.5 * std::numbers::inv_pi;
  const FluidConstants& c = outlook.constants;
  const double scale = outlook.dt * outlook.dt / (c.restDensity * std::pow(double(c.spacing), 3));
  const double number = tension * scale;
  if (number <= kMax * (1 + kSettingRounding)) return;
  outlook.warn(
      *this,
      fmt::format("tension·dt²/(rest_density·spacing³) = {:.3g}, and above {:.2g} the surface shakes", number,
                  kMax),
      fmt::format("a tension of at most {:.2g} N/m, or a world.dt of at most {:.2g} s", kMax / scale,
                  outlook.dt * std::sqrt(kMax / number)));
}

}  // namespace weir
