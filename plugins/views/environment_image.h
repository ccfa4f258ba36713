// Light from all sides, as a picture holds it: what mirrors see, and what it does to matt surfaces.
#pragma once

#include <array>
#include <vector>

#include "framework/base/vec.h"

namespace weir::rendering {

/// Light by direction, in the scene's units, in which white paper in the sun is about 1. Column i of row j is
/// that from (sin a cos b, sin b, cos a cos b) with a = 2 pi ((i + 1/2) / width - 1/2) and
/// b = pi ((j + 1/2) / height - 1/2): y is up, and the first row is below.
struct EnvironmentImage {
  int width = 0, height = 0;
  std::vector<Vec3f> light;  ///< width height
  /// What matt white of each direction n shows: n^T M n for red, green and blue, n with a 1 behind it. Rows
  /// of four.
  std::array<std::array<float, 16>, 3> ambient{};
  Vec3f mean;        ///< of all directions
  Vec3f towardsSun;  ///< the middle of the brightest light

  Vec3f directionOf(int column, int row) const;
};

/// Fills `ambient`, `mean` and `towardsSun`. The light that matt surfaces get is that of spherical harmonics
/// up to the second degree (R. Ramamoorthi, P. Hanrahan 2001), without what is above four units: that is the
/// sun, which is a light of its own.
void findAmbient(EnvironmentImage& image);

}  // namespace weir::rendering
