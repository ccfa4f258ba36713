#include "plugins/views/water_settings.h"

#include <algorithm>
#include <cmath>

#include "framework/base/error.h"

namespace weir::rendering {

void FoamSettings::validate() const {
  if (range.get().x == range.get().y)
    throw sceneError("the range is empty", "[clear, white] with two different values")
        .inParameter(range.name());
}

void WaterSettings::validate() const {
  if (scattered.get().a != 1)
    throw sceneError("the colour has an opacity", "[red, green, blue]").inParameter(scattered.name());
}

WaterView waterView(const WaterSettings& settings, float smoothing, float foamOpacity) {
  return {.absorption = settings.absorption,
          .scattering = settings.scattering,
          .scattered = settings.scattered,
          .refractiveIndex = settings.refractiveIndex,
          .smoothing = smoothing,
          .foamOpacity = foamOpacity};
}

}  // namespace weir::rendering
