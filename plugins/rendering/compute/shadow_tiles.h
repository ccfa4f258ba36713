// Where a shadow map says at once that all is lit, or that nothing is.
#pragma once

#include "framework/base/vec.h"
#include "framework/compute/array.h"

namespace weir::rendering {

/// Of each square of texels of a shadow map: the least and the largest depth there and in the eight squares
/// around it, so within kSide texels of any place in the square.
struct ShadowTiles {
  static constexpr int kSide = 8;  ///< texels

  ArrayView<const Vec2f> depths;
  int perRow = 0;

  static int perRowOf(int resolution) { return (resolution - 1) / kSide + 1; }
};

/// Fills `depths`; they and the scratch have the size perRowOf(resolution)².
template <class Backend>
void findShadowTiles(Backend& device, ArrayView<const float> shadow, int resolution, ArrayView<Vec2f> depths,
                     ArrayView<Vec2f> scratch);

}  // namespace weir::rendering
