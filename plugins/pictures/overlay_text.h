// What stands on a picture of a scene.
#pragma once

#include <string>
#include <vector>

#include "plugins/rendering/overlay/overlay.h"
#include "plugins/views/scene_capture.h"
#include "plugins/views/scene_view.h"

namespace weir::rendering {

/// Title, time and number of particles where the settings want them, what the colours mean, and plots.
OverlayText overlayText(const RenderSettings& settings, const std::string& title, const SceneSnapshot& scene,
                        const ColorKey& key, const ColorMap& map, std::vector<Plot> plots);

}  // namespace weir::rendering
