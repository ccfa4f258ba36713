#include "plugins/rendering/compute/shadow_tiles.h"

#include "framework/compute/parallel.h"

namespace weir::rendering {

namespace {

struct FindTile {
  ArrayView<const float> shadow;
  int resolution, perRow;
  ArrayView<Vec2f> depths;

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
    depths[tile] = {near, far};
  }
};

struct AddNeighbors {
  ArrayView<const Vec2f> depths;
  int perRow;
  ArrayView<Vec2f> around;

  WEIR_HD void operator()(std::int64_t tile) const {
    const int column = static_cast<int>(tile % perRow), row = static_cast<int>(tile / perRow);
    Vec2f found{1, 0};
    for (int y = row > 0 ? row - 1 : 0; y <= row + 1 && y < perRow; ++y)
      for (int x = column > 0 ? column - 1 : 0; x <= column + 1 && x < perRow; ++x) {
        const Vec2f there = depths[std::int64_t{y} * perRow + x];
        found = {there.x < found.x ? there.x : found.x, there.y > found.y ? there.y : found.y};
      }
    around[tile] = found;
  }
};

}  // namespace

template <class Backend>
void findShadowTiles(Backend& device, ArrayView<const float> shadow, int resolution, ArrayView<Vec2f> depths,
                     ArrayView<Vec2f> scratch) {
  const int perRow = ShadowTiles::perRowOf(resolution);
  parallelFor(device, "shadow tiles", depths.size, FindTile{shadow, resolution, perRow, scratch});
  parallelFor(device, "shadow tiles", depths.size, AddNeighbors{scratch, perRow, depths});
}

template void findShadowTiles(ThisBackend&, ArrayView<const float>, int, ArrayView<Vec2f>, ArrayView<Vec2f>);

}  // namespace weir::rendering
