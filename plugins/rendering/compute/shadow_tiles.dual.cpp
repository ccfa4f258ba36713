#include "plugins/rendering/compute/shadow_tiles.h"

#include "framework/compute/parallel.h"

namespace weir::rendering {

namespace {

struct FindTile {
  ArrayView<const float> shadow;
  int resolution, perRow;
  ArrayView<float> nearest, farthest;

  WEIR_HD void operator()(std::int64_t tile) const {
    const int left = static_cast<int>(tile % perRow) * ShadowTiles::kSide;
    const int low = static_cast<int>(tile / perRow) * ShadowTiles::kSide;
    float near = 1, far = 0;
    for (int y = low; y < low + ShadowTiles::kSide && y < resolution; ++y)
      for (int x = left; x < left + ShadowTiles::kSide && x < resolution; ++x) {
        const float depth = shadow[std::int64_t{y} * resolution + x];
        near = depth < near ? depth : near;
        far = depth > far ? depth : far;
      }
    nearest[tile] = near;
    farthest[tile] = far;
  }
};

struct AddNeighbors {
  ArrayView<const float> nearest, farthest;
  int perRow;
  ArrayView<float> nearestAround, farthestAround;

  WEIR_HD void operator()(std::int64_t tile) const {
    const int column = static_cast<int>(tile % perRow), row = static_cast<int>(tile / perRow);
    float near = 1, far = 0;
    for (int y = row > 0 ? row - 1 : 0; y <= row + 1 && y < perRow; ++y)
      for (int x = column > 0 ? column - 1 : 0; x <= column + 1 && x < perRow; ++x) {
        const std::int64_t at = std::int64_t{y} * perRow + x;
        near = nearest[at] < near ? nearest[at] : near;
        far = farthest[at] > far ? farthest[at] : far;
      }
    nearestAround[tile] = near;
    farthestAround[tile] = far;
  }
};

}  // namespace

template <class Backend>
void findShadowTiles(Backend& device, ArrayView<const float> shadow, int resolution, ArrayView<float> nearest,
                     ArrayView<float> farthest, ArrayView<float> nearScratch, ArrayView<float> farScratch) {
  const int perRow = ShadowTiles::perRowOf(resolution);
  parallelFor(device, "shadow tiles", nearest.size,
              FindTile{shadow, resolution, perRow, nearScratch, farScratch});
  parallelFor(device, "shadow tiles", nearest.size,
              AddNeighbors{nearScratch, farScratch, perRow, nearest, farthest});
}

template void findShadowTiles(ThisBackend&, ArrayView<const float>, int, ArrayView<float>, ArrayView<float>,
                              ArrayView<float>, ArrayView<float>);

}  // namespace weir::rendering
