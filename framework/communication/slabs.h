// How space is divided among ranks: slabs of whole layers of cells along one axis.
//
// Cells are those of the search for neighbours, counted through all of space and not wrapped into its grid.
// Neighbours stand in cells side by side, so a slab needs copies of one layer at each side. Who owns what
// changes no result.
//
// Layers end somewhere, and what is beyond counts to the outermost ones, whose cells have no end. Where that
// is does change the order of lists, as particles of one cell stand in the order of their ids; so it goes by
// the box of all particles and not by how many slabs there are.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "framework/base/api.h"
#include "framework/base/vec.h"

namespace WEIR_API weir {

/// The layers of cells across an axis.
struct CellLayers {
  static constexpr float kFarthest = 5e8f;  // cells, from the origin

  int axis = 2;               ///< 0, 1, 2: x, y, z
  float inverseCellSize = 1;  ///< 1/m
  int first = 0, count = 1;   ///< at least one

  /// That of a finite point.
  WEIR_HD int layerOf(const Vec3f& p) const {
    const int layer = countedLayerOf(p), last = first + count - 1;
    return layer < first ? first : (layer > last ? last : layer);
  }
  /// Through all of space.
  WEIR_HD int countedLayerOf(const Vec3f& p) const {
    const float cell = floorf((axis == 0 ? p.x : axis == 1 ? p.y : p.z) * inverseCellSize);
    return static_cast<int>(cell > kFarthest ? kFarthest : (cell < -kFarthest ? -kFarthest : cell));
  }
};

/// Layers across the longest axis of a box, with room on both sides for what it will hold until it is
/// measured again. `cellSize` in m.
CellLayers layersAcross(const Aabb& box, float cellSize);

/// Slab k has the layers from cuts[k - 1] up to cuts[k]; the first one begins and the last one ends where all
/// layers do. It may be empty.
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
};

struct Slabs {
  CellLayers layers;
  std::vector<int> cuts;

  int count() const { return static_cast<int>(cuts.size()) + 1; }
  SlabsView view() const { return {layers, cuts.data(), count()}; }
  /// The layers of slab k; none if it is empty.
  CellLayers layersOf(int k) const;
  /// The slab whose last layer is below slab k, and the one whose first layer is above it, empty ones left
  /// out. Empty slabs touch none.
  std::optional<int> below(int k) const;
  std::optional<int> above(int k) const;
};

/// Cuts between layers, of which the first is `firstLayer` and each has so many particles, so that the slab
/// with the most particles has as few as can be. Depends on the numbers alone.
std::vector<int> cutLayers(int firstLayer, std::span<const std::int64_t> particles, int slabs);

}  // namespace weir
