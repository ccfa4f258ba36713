// Writing on a finished picture: title, time, number of particles, what the colours mean, and plots.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "plugins/rendering/overlay/font.h"
#include "plugins/rendering/overlay/plot.h"
#include "plugins/views/view.h"

namespace weir::rendering {

/// What the colours of the particles mean.
struct ColorBar {
  ColorMap map;
  float lowest = 0, highest = 1;
  std::string caption;  ///< "speed in m/s"
};

struct OverlayText {
  std::string title;  ///< left out if empty
  std::optional<double> seconds;
  std::optional<std::int64_t> particles;
  std::optional<ColorBar> bar;
  std::vector<Plot> plots;  ///< from the left to the right
  bool lightText = false;   ///< for dark backgrounds
};

/// Whether text on this background should be light.
bool wantsLightText(const Color& backgroundTop, const Color& backgroundBottom);

class Overlay {
 public:
  /// The folder holds DejaVuSans.ttf and DejaVuSans-Bold.ttf. Throws an io Error if one of them is not a
  /// font.
  explicit Overlay(const std::filesystem::path& fontFolder);

  /// All sizes follow the picture's height. What does not fit is cut off at the picture's edges.
  void draw(const OverlayText& text, Picture& picture);

 private:
  Font regular_, bold_;
};

}  // namespace weir::rendering
