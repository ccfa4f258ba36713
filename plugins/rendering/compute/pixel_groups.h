// How kernels that work on whole pictures share them out.
#pragma once

#include "plugins/rendering/compute/pixel_lanes.h"

namespace weir::rendering {

/// The elements of a kernel, each of which is kPixels pixels of one row.
struct PixelGroups {
  int width, height;

  WEIR_HD std::int64_t perRow() const { return (width + kPixels - 1) / kPixels; }
  std::int64_t count() const { return perRow() * height; }
  WEIR_HD int row(std::int64_t k) const { return static_cast<int>(k / perRow()); }
  WEIR_HD int column(std::int64_t k) const { return static_cast<int>(k % perRow()) * kPixels; }
  /// Those of the row's end stand for the places behind it, too.
  WEIR_HD Ints columns(std::int64_t k) const { return clamped(intsFrom(column(k)), 0, width - 1); }
  WEIR_HD void store(std::int64_t k, const Number& values, float* to) const {
    const int first = column(k);
    float* line = to + std::int64_t{row(k)} * width + first;
    for (int l = 0; l < kPixels; ++l)
      if (first + l < width) line[l] = laneOf(values, l);
  }
};

}  // namespace weir::rendering
