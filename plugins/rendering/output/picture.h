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

  std::size_t byteCount() const {
    return std::size_t{3} * static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
  /// Whether the size is positive and there are as many bytes as it needs.
  bool isWhole() const { return width > 0 && height > 0 && rgb.size() == byteCount(); }
};

}  // namespace weir::rendering
