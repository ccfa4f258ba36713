// Colour maps: which colour a number gets.
#pragma once

#include <vector>

#include "framework/base/vec.h"

namespace weir::rendering {

enum class ColorMapName { kViridis, kTurbo, kCividis, kCoolwarm, kWater };

/// sRGB colours, evenly spread from 0 to 1, linear between them. The maps with names are tables of control
/// colours and are within 0.01 of the originals (cividis 0.023, near its dark end): viridis (S. van der Walt,
/// N. Smith 2015), turbo (A. Mikhailov 2019), cividis (J. Nuñez, C. Anderton, R. Renslow 2018), coolwarm (K.
/// Moreland 2009). Water is our own.
class ColorMap {
 public:
  ColorMap(ColorMapName name = ColorMapName::kViridis);
  /// At least two colours.
  explicit ColorMap(std::vector<Vec3f> colors);

  /// The colour at t, components in [0, 1]. t is clamped to [0, 1]; NaN gives a neutral grey, which no map
  /// holds at its ends.
  Vec3f at(float t) const;

 private:
  std::vector<Vec3f> colors_;
};

}  // namespace weir::rendering
