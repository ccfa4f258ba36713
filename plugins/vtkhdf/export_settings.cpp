#include "plugins/vtkhdf/export_settings.h"

#include <algorithm>
#include <cmath>

#include "framework/base/error.h"
#include "framework/base/text.h"

namespace weir {

void ExportSettings::validate() const {
  if (rate.get() && every != 1)
    throw sceneError("both every and rate are given", "one of them").inParameter(rate.name());
  if (!attributes.get()) return;
  for (const std::string& name : *attributes.get())
    if (std::count(attributes.get()->begin(), attributes.get()->end(), name) > 1)
      throw sceneError("the attribute " + inQuotes(name) + " is there twice", "each name once")
          .inParameter(attributes.name());
}

bool ExportSettings::wants(std::int64_t frame, double frameRate) const {
  if (!rate.get()) return frame % every == 0;
  // The first frame at or behind each multiple of 1 / rate.
  constexpr double kRounding = 1e-9;
  const auto multiples = [&](std::int64_t k) {
    return std::floor(static_cast<double>(k) * *rate.get() / frameRate * (1 + kRounding));
  };
  return frame == 0 || multiples(frame) > multiples(frame - 1);
}

float ExportSettings::grid() const {
  return positionError > 0 ? std::exp2(std::floor(std::log2(2 * positionError))) : 0;
}

float roundedTo(float grid, float x) {
  // Exact but for the rounding itself: divisions and products with a power of two are.
  const float multiple = std::nearbyint(x / grid);
  return std::isfinite(multiple) ? multiple * grid : x;
}

}  // namespace weir
