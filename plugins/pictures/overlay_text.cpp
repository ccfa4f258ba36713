#include "plugins/pictures/overlay_text.h"

#include <utility>

namespace weir::rendering {

OverlayText overlayText(const RenderSettings& settings, const std::string& title, const SceneSnapshot& scene,
                        const ColorKey& key, const ColorMap& map, std::vector<Plot> plots) {
  OverlayText text;
  text.lightText = wantsLightText(settings.backgroundTop, settings.backgroundBottom);
  if (settings.overlay) {
    text.title = title;
    text.seconds = scene.time;
    text.particles = scene.particles;
  }
  const std::string caption = key.unit.empty() ? key.quantity : key.quantity + " in " + key.unit;
  text.plots = std::move(plots);
  if (key.shown) text.bar = ColorBar{map, key.low, key.high, caption};
  return text;
}

}  // namespace weir::rendering
