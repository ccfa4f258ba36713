// Pictures whose content a test can tell after they went through a file.
#pragma once

#include "plugins/video/picture.h"

namespace weir::test {

struct Rgb {
  int red = 0, green = 0, blue = 0;
  bool operator==(const Rgb&) const = default;
};

inline rendering::Picture plainPicture(int width, int height, Rgb color) {
  rendering::Picture picture{width, height, {}};
  while (picture.rgb.size() < picture.byteCount())
    for (int channel : {color.red, color.green, color.blue})
      picture.rgb.push_back(static_cast<std::uint8_t>(channel));
  return picture;
}

/// Every pixel differs from its neighbours, so that no encoder makes it small.
inline rendering::Picture noisePicture(int width, int height, std::uint32_t seed) {
  rendering::Picture picture{width, height, {}};
  std::uint32_t state = 2654435761u * (seed + 1);
  while (picture.rgb.size() < picture.byteCount()) {
    state = 1664525u * state + 1013904223u;
    picture.rgb.push_back(static_cast<std::uint8_t>(state >> 24));
  }
  return picture;
}

inline Rgb pixelOf(const rendering::Picture& picture, int x, int y) {
  const std::size_t at = 3 * (static_cast<std::size_t>(y) * picture.width + x);
  return {picture.rgb.at(at), picture.rgb.at(at + 1), picture.rgb.at(at + 2)};
}

}  // namespace weir::test
