// A grid of cubic cells that wraps around in all three directions.
//
// Cell (i, j, k) and cell (i + nx, j, k) share their storage, so the grid covers all of space with as many
// cells as there is memory for, and never needs the bounding box of the particles to be right. A shape close
// to the box is only faster: particles of different places that share a cell are told apart by their
// distance. With at least three cells in each direction the 27 cells around a point are all different.
//
// Where particles are divided into slabs (slabs.h), a grid has the layers of one slab, from 0 on, and behind
// these two for copies of what is beside it: the layer above it and, as it wraps around, the one below. So
// in the order of cells all copies stand behind all particles of the slab.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>

#include "framework/base/api.h"
#include "framework/base/vec.h"

namespace WEIR_API weir {

struct CellGrid {
  static constexpr int kMinCells = 3;  // in each direction

  float inverseCellSize = 1;                     ///< 1/m
  Vec3i cells{kMinCells, kMinCells, kMinCells};  ///< along the axes of the grid
  /// The axis of space (0, 1, 2: x, y, z) that is the grid's z, whose layers of cells stand one behind the
  /// other. The two change places.
  int slowestAxis = 2;
  /// Of a slab: its first layer, counted through all of space, and how many it has; what is beyond counts to
  /// the outermost ones. 0 layers where the grid is of all particles.
  int firstLayer = 0, slabLayers = 0;

  WEIR_HD int cellCount() const { return cells.x * cells.y * cells.z; }
  WEIR_HD int cellsInLayer() const { return cells.x * cells.y; }

  /// A vector of space along the axes of the grid.
  template <class T>
  WEIR_HD Vec3<T> along(const Vec3<T>& v) const {
    return slowestAxis == 2 ? v : (slowestAxis == 1 ? Vec3<T>{v.x, v.z, v.y} : Vec3<T>{v.z, v.y, v.x});
  }

  /// The cell of a finite point, wrapped into the grid, or of a slab.
  WEIR_HD Vec3i cellOf(const Vec3f& p) const {
    const Vec3f at = along(p);
    return {wrapped(at.x, cells.x), wrapped(at.y, cells.y),
            slabLayers > 0 ? layerInSlab(counted(at.z)) : wrapped(at.z, cells.z)};
  }
  WEIR_HD int index(const Vec3i& c) const { return (c.z * cells.y + c.y) * cells.x + c.x; }

  /// The neighbour of cell c in a direction with n cells; offset is -1, 0 or 1.
  WEIR_HD static int step(int c, int offset, int n) {
    c += offset;
    return c < 0 ? c + n : (c >= n ? c - n : c);
  }

 private:
  /// Through all of space.
  WEIR_HD int counted(float x) const {
#ifdef __CUDA_ARCH__
    return __float2int_rd(x * inverseCellSize);  // of far-away particles the farthest int
#else
    constexpr float kFarthest = 1e9f;  // cells; keeps the conversion to int defined for far-away particles
    const float cell = floorf(x * inverseCellSize);
    return static_cast<int>(cell > kFarthest ? kFarthest : (cell < -kFarthest ? -kFarthest : cell));
#endif
  }
  WEIR_HD int layerInSlab(int layer) const {
    const int end = firstLayer + slabLayers;
    return layer < firstLayer ? 0 : (layer < end ? layer : end - 1) - firstLayer;
  }
  WEIR_HD int wrapped(float x, int n) const {
    const int c = counted(x);
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
