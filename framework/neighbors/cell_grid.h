// A grid of cubic cells that wraps around in all three directions.
//
// Cell (i, j, k) and cell (i + nx, j, k) share their storage, so the grid covers all of space with as many
// cells as there is memory for, and never needs the bounding box of the particles to be right. A shape close
// to the box is only faster: particles of different places that share a cell are told apart by their
// distance. With at least three cells in each direction the 27 cells around a point are all different.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>

#include "framework/base/api.h"
#include "framework/base/vec.h"

namespace WEIR_API weir {

struct CellGrid {
  static constexpr int kMinCells = 3;  // in each direction

  float inverseCellSize = 1;  ///< 1/m
  Vec3i cells{kMinCells, kMinCells, kMinCells};

  WEIR_HD int cellCount() const { return cells.x * cells.y * cells.z; }

  /// The cell of a finite point, wrapped into the grid.
  WEIR_HD Vec3i cellOf(const Vec3f& p) const {
    return {wrapped(p.x, cells.x), wrapped(p.y, cells.y), wrapped(p.z, cells.z)};
  }
  WEIR_HD int index(const Vec3i& c) const { return (c.z * cells.y + c.y) * cells.x + c.x; }

  /// The neighbour of cell c in a direction with n cells; offset is -1, 0 or 1.
  WEIR_HD static int step(int c, int offset, int n) {
    c += offset;
    return c < 0 ? c + n : (c >= n ? c - n : c);
  }

 private:
  WEIR_HD int wrapped(float x, int n) const {
#ifdef __CUDA_ARCH__
    const int c = __float2int_rd(x * inverseCellSize);  // of far-away particles the farthest int
#else
    constexpr float kFarthest = 1e9f;  // cells; keeps the conversion to int defined for far-away particles
    float cell = floorf(x * inverseCellSize);
    cell = cell > kFarthest ? kFarthest : (cell < -kFarthest ? -kFarthest : cell);
    const int c = static_cast<int>(cell);
#endif
    if (c >= 0 && c < n) return c;  // division takes long
    const int m = c % n;
    return m < 0 ? m + n : m;
  }
};

/// A grid of at most `maxCells` cells whose shape follows a bounding box. Where the box has fewer than
/// `fewestCells`, the grid is larger than it, up to about that number. The mean of the points tells where in
/// the box nearly all of them are; the grid may then leave out what is opposite, whose few points share the
/// cells of others.
CellGrid chooseCellGrid(const Aabb& box, float cellSize, std::int64_t maxCells, std::int64_t fewestCells = 27,
                        const std::optional<Vec3f>& mean = {});

}  // namespace weir
