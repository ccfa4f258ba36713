#include "plugins/views/video_settings.h"

#include <cmath>

namespace weir::rendering {

std::int64_t VideoSettings::timesShown(std::int64_t frame, double frameRate) const {
  if (!rate.get()) return 1;
  const double perFrame = *rate.get() / (frameRate * speed);
  // Those at exactly a frame's time show that frame, whatever rounding makes of it.
  constexpr double kRounding = 1e-9;
  const auto shownBefore = [&](std::int64_t k) {
    return static_cast<std::int64_t>(std::ceil(static_cast<double>(k) * perFrame - kRounding));
  };
  return shownBefore(frame + 1) - shownBefore(frame);
}

}  // namespace weir::rendering
