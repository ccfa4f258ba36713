// Where a shadow map says at once that all is lit, or that nothing is.
#pragma once

#include "framework/compute/array.h"

namespace weir::rendering {

/// Of each square of texels of a shadow map: the least and the largest depth there and in the eight squares
/// around it, so within kSide texels of any place in the square.
struct ShadowTiles {
  static constexpr int kSide = 8;  ///< texels

  ArrayView<const float> nearest, farthest;
  int perRow = 0;

  static int perRowOf(int resolution) { return (resolution - 1) / kSide + 1; }
};

/// Fills `nearest` and `farthest`; the scratches have their size, that of perRowOf(resolution)².
template <class Backend>
void findShadowTiles(Backend& device, ArrayView<const float> shadow, int resolution, ArrayView<float> nearest,
                     ArrayView<float> farthest, ArrayView<float> nearScratch, ArrayView<float> farScratch);

}  // namespace weir::rendering
