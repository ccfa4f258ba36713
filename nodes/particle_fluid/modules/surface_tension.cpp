#include "nodes/particle_fluid/modules/surface_tension.h"

#include <fmt/format.h>

#include <cmath>

#include "framework/graph/setting_warning.h"

namespace weir {

void SurfaceTension::reset(FluidStep& fluid) {
  constexpr float kMinSupport = 2;  // spacings
  constexpr float kRounding = 1e-3f;
  const float support = fluid.constants.supportRadius / fluid.constants.spacing;
  if (enabled() && coefficient > 0 && support < kMinSupport - kRounding)
    fluid.time.log.warn(
        fmt::format("module '{}': surface tension needs a support_ratio of at least {}; at {:.4g} drops do "
                    "not become round",
                    name(), kMinSupport, support));
}

void SurfaceTension::warn(const FluidOutlook& outlook) const {
  constexpr double kMax = 0.5;
  const FluidConstants& c = outlook.constants;
  const double scale = outlook.dt * outlook.dt / (c.restDensity * std::pow(double(c.spacing), 4));
  const double number = coefficient * scale;
  if (number <= kMax * (1 + kSettingRounding)) return;
  outlook.warn(
      *this,
      fmt::format("coefficient·dt²/(rest_density·spacing⁴) = {:.3g}, and above 1 the surface shakes", number),
      fmt::format("a coefficient of at most {:.2g} N, or a world.dt of at most {:.2g} s", kMax / scale,
                  outlook.dt * std::sqrt(kMax / number)));
}

}  // namespace weir
