// Colour maps: which colour a number gets.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "framework/base/vec.h"

namespace weir::rendering {

enum class ColorMapName { kViridis, kTurbo, kCividis, kCoolwarm, kWater };

/// The sRGB colour at t, components in [0, 1]. t is clamped to [0, 1]; NaN gives a neutral grey, which no map
/// holds at its ends. The maps are interpolated from tables of control colours and are within 0.01 of
/// the originals (cividis 0.023, near its dark end): viridis (S. van der Walt, N. Smith 2015), turbo (A.
/// Mikhailov 2019), cividis (J. Nuñez, C. Anderton, R. Renslow 2018), coolwarm (K. Moreland 2009). Water is
/// our own.
Vec3f colorAt(ColorMapName map, float t);

/// A map by name, or of colours of one's own.
class ColorMap {
 public:
  ColorMap(ColorMapName name = ColorMapName::kViridis) : name_(name) {}
  /// At least two sRGB colours, evenly spread from 0 to 1, linear between them.
  explicit ColorMap(std::vector<Vec3f> colors);

  /// As colorAt().
  Vec3f at(float t) const;

 private:
  ColorMapName name_ = ColorMapName::kViridis;
  std::vector<Vec3f> colors_;  // empty: that of the name
};

/// 256 entries of 8-bit sRGB red, green, blue: entry i is the colour at i/255.
std::array<std::uint8_t, 3 * 256> colorTable(ColorMapName map);

}  // namespace weir::rendering
