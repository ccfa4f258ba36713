// Which cells around a point may hold something within a cell's width of it.
#pragma once

#include "framework/compute/lanes.h"
#include "framework/neighbors/cell_grid.h"

namespace weir {

/// Which of the three cells of a row, -1 to 1, are to be searched; none if last is below first.
struct RowPart {
  int first = -1, last = 1;
};

/// Those within a cell's width of a point, by where it stands in its cell.
struct RowsWithinReach {
  Vec3f fraction;  // of the point in its cell, in cells, along the axes of the grid
  float margin;    // cells, by which the fraction may be wrong

  WEIR_HD RowsWithinReach(const Vec3f& p, const CellGrid& grid) {
    constexpr float kMin = 1e-4f, kRounding = 3e-7f;
    const Vec3f g = grid.inverseCellSize * grid.along(p);
    fraction = {g.x - floorf(g.x), g.y - floorf(g.y), g.z - floorf(g.z)};
    margin = kMin + kRounding * (fabsf(g.x) + fabsf(g.y) + fabsf(g.z));
  }

  /// Of the row at dy, dz in {-1, 0, 1}.
  WEIR_HD RowPart operator()(int dy, int dz) const {
    const float y = distance(fraction.y, dy), z = distance(fraction.z, dz);
    const float rest = 1 - y * y - z * z;
    if (!(rest > 0)) return {0, -1};
    const float along = fastSqrt(rest) + margin;
    return {fraction.x < along ? -1 : 0, fraction.x + along >= 1 ? 1 : 0};
  }

 private:
  WEIR_HD float distance(float at, int step) const {
    const float d = step < 0 ? at : (step > 0 ? 1 - at : 0.0f);
    return positivePart(d - margin);
  }
};

}  // namespace weir
