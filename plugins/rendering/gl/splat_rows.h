// What kernels that splat spheres know of the depths that are there already: several samples of a row at a
// time, and the farthest of each square.
#pragma once

#include "framework/compute/array.h"
#include "framework/compute/atomics.h"
#include "plugins/rendering/compute/pixel_lanes.h"
#include "plugins/rendering/gl/splat_shapes.h"

namespace weir::rendering::gl {

// Depths that kernels lower with atomicMin, as bits: alone, or in the upper half. Threads may see them late,
// which only costs time, so the CPU reads several with one instruction. The thread sanitizer need not know.
#if defined(WEIR_HAS_LANES)
__attribute__((no_sanitize("thread"))) inline Number depthsFrom(const std::uint32_t* first) {
  Ints bits;
  __builtin_memcpy(&bits, first, sizeof bits);
  return numbersOfBits(bits);
}
__attribute__((no_sanitize("thread"))) inline Number depthsFrom(const std::uint64_t* first) {
  Ints low, high;
  __builtin_memcpy(&low, first, sizeof low);
  __builtin_memcpy(&high, first + kPixels / 2, sizeof high);
  return numbersOfBits(__builtin_shufflevector(low, high, 1, 3, 5, 7, 9, 11, 13, 15));
}
#else
WEIR_HD inline Number depthsFrom(const std::uint32_t* first) {
  return std::bit_cast<float>(currentMin(first));
}
WEIR_HD inline Number depthsFrom(const std::uint64_t* first) {
  return std::bit_cast<float>(static_cast<std::uint32_t>(currentMin(first) >> 32));
}
#endif

/// The depths from a column on; behind the end of the row, those of its last columns.
template <class Least>
WEIR_HD Number depthsOfRow(const Least* line, int column, int width) {
  if (column + kPixels <= width) return depthsFrom(line + column);
  Least last[kPixels];
  for (int l = 0; l < kPixels; ++l)
    last[l] = currentMin(line + (column + l < width ? column + l : width - 1));
  return depthsFrom(last);
}

/// The farthest depth in each square of samples as it once was: depths only ever come nearer.
struct FarthestTiles {
  static constexpr int kSide = 8;  // samples

  ArrayView<const float> farthest;  ///< empty: nothing is known
  int perRow = 0;

  /// Whether all samples of a rectangle are known to see something nearer.
  WEIR_HD bool hide(const Samples& x, const Samples& y, float depth) const {
    if (farthest.size == 0) return false;
    for (int row = y.first / kSide; row <= y.last / kSide; ++row)
      for (int column = x.first / kSide; column <= x.last / kSide; ++column)
        if (!(farthest[std::int64_t{row} * perRow + column] < depth)) return false;
    return true;
  }
};

template <class Least>
struct FindFarthest {
  const Least* min;
  int width, height, perRow;
  float* farthest;

  WEIR_HD void operator()(std::int64_t tile) const {
    const int left = static_cast<int>(tile % perRow) * FarthestTiles::kSide;
    const int low = static_cast<int>(tile / perRow) * FarthestTiles::kSide;
    Number found = 0.0f;
    for (int y = low; y < low + FarthestTiles::kSide && y < height; ++y)
      for (int x = left; x < left + FarthestTiles::kSide && x < width; x += kPixels)
        found = atLeast(found, depthsOfRow(min + std::int64_t{y} * width, x, width));
    float one = 0;
    for (int l = 0; l < kPixels; ++l) one = laneOf(found, l) > one ? laneOf(found, l) : one;
    farthest[tile] = one;
  }
};

}  // namespace weir::rendering::gl
