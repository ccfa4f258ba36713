// Text and the colour bar, drawn onto a finished picture.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "plugins/rendering/color_map.h"
#include "plugins/rendering/output/picture.h"

namespace weir::rendering {

struct ColorBar {
  std::string quantity, unit;
  float low = 0, high = 1;
  ColorMapName map = ColorMapName::kViridis;
};

class Overlay {
 public:
  /// Throws an io Error that names the file if it is no font.
  explicit Overlay(const std::filesystem::path& font);
  ~Overlay();

  /// Title, time in seconds and number of particles, in the upper left corner. Sizes follow the picture's
  /// height.
  void drawCaption(Picture& picture, const std::string& title, double time, std::int64_t particles);
  /// A bar with the values of its colours, at the right edge.
  void drawColorBar(Picture& picture, const ColorBar& bar);

 private:
  struct Font;
  std::unique_ptr<Font> font_;
};

/// Round numbers between low and high, both included if they are round: about `wanted` of them.
std::vector<double> roundTicks(double low, double high, int wanted);

/// The font that comes with the program; the system's if that is missing. Throws an io Error if there is
/// none.
std::filesystem::path fontFile();

}  // namespace weir::rendering
