#include "nodes/particle_fluid/modules/surface_tension.h"

#include <fmt/format.h>

namespace weir {

void SurfaceTension::reset(FluidStep& fluid) {
  constexpr float kLeastSupport = 2;  // spacings
  constexpr float kRounding = 1e-3f;
  const float support = fluid.constants.supportRadius / fluid.constants.spacing;
  if (enabled() && coefficient > 0 && support < kLeastSupport - kRounding)
    fluid.time.log.warn(
        fmt::format("module '{}': surface tension needs a support_ratio of at least {}; at {:.4g} drops do "
                    "not become round",
                    name(), kLeastSupport, support));
}

}  // namespace weir
