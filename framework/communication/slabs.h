// How space is divided among ranks: slabs of whole layers of cells along one axis.
//
// Cells are those of the search for neighbours, counted through all of space and not wrapped into its grid.
// Neighbours stand in cells side by side, so a slab needs copies of one layer at each side. Who owns what
// changes no result.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "framework/base/api.h"
#include "framework/base/vec.h"

namespace WEIR_API weir {

/// The layers of cells across an axis.
struct CellLayers {
  static constexpr float kFarthest = 1e9f;  // cells; what is beyond is in the last one

  int axis = 0;               ///< 0, 1, 2: x, y, z
  float inverseCellSize = 1;  ///< 1/m

  /// That of a finite point.
  WEIR_HD int layerOf(const Vec3f& p) const {
    const float cell = floorf((axis == 0 ? p.x : axis == 1 ? p.y : p.z) * inverseCellSize);
    return static_cast<int>(cell > kFarthest ? kFarthest : (cell < -kFarthest ? -kFarthest : cell));
  }
};

/// Slab k is from cuts[k - 1] up to cuts[k], the first and the last one without end. It may be empty.
struct SlabsView {
  CellLayers layers;
  const int* cuts = nullptr;  ///< ascending, one fewer than there are slabs
  int count = 1;              ///< of slabs

  WEIR_HD int slabOfLayer(int layer) const {
    int k = 0;
    while (k + 1 < count && layer >= cuts[k]) ++k;
    return k;
  }
  WEIR_HD int slabOf(const Vec3f& p) const { return slabOfLayer(layers.layerOf(p)); }
  /// Whether slab k has a layer that touches the one of p, which is not in it.
  WEIR_HD bool touches(int k, const Vec3f& p) const {
    const int layer = layers.layerOf(p);
    return slabOfLayer(layer - 1) == k || slabOfLayer(layer + 1) == k;
  }
};

struct Slabs {
  CellLayers layers;
  std::vector<int> cuts;

  int count() const { return static_cast<int>(cuts.size()) + 1; }
  SlabsView view() const { return {layers, cuts.data(), count()}; }
  /// Those that touch slab k, in ascending order. Both sides agree on it.
  std::vector<int> neighborsOf(int k) const;
};

/// Cuts between layers, of which the first is `firstLayer` and each has so many particles, so that the slab
/// with the most particles has as few as can be. Depends on the numbers alone.
std::vector<int> cutLayers(int firstLayer, std::span<const std::int64_t> particles, int slabs);

}  // namespace weir
