// A finished picture in memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace weir::rendering {

struct Picture {
  int width = 0;   ///< in pixels
  int height = 0;  ///< in pixels
  /// Red, green and blue (sRGB) of each pixel, rows from the top, no bytes between them: 3 width height
  /// bytes.
  std::vector<std::uint8_t> rgb;
  /// Opacity of each pixel, 255 is opaque, in the same order. Colours are not multiplied with it. Empty: the
  /// whole picture is opaque.
  std::vector<std::uint8_t> alpha = {};

  std::size_t byteCount() const {
    return std::size_t{3} * static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
  /// Whether the size is positive and there are as many bytes as it needs.
  bool isWhole() const {
    return width > 0 && height > 0 && rgb.size() == byteCount() &&
           (alpha.empty() || 3 * alpha.size() == rgb.size());
  }
  /// Red, green, blue and opacity of each pixel.
  std::vector<std::uint8_t> rgba() const {
    std::vector<std::uint8_t> all(rgb.size() / 3 * 4, 255);
    for (std::size_t i = 0; 3 * i < rgb.size(); ++i) {
      for (std::size_t c = 0; c < 3; ++c) all[4 * i + c] = rgb[3 * i + c];
      if (!alpha.empty()) all[4 * i + 3] = alpha[i];
    }
    return all;
  }
};

}  // namespace weir::rendering
