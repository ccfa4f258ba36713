#include "nodes/fluid_surface/sparse_grid.h"

namespace weir {

namespace {

struct FindAround {
  ArrayView<const std::uint64_t> keys;
  ArrayView<int> around;

  WEIR_HD void operator()(std::int64_t block) const {
    const Vec3i c = BlockKey::coordinates(keys[block]);
    int* found = around.data + block * GridView::kAround;
    for (int z = -1; z <= 1; ++z)
      for (int y = -1; y <= 1; ++y)
        for (int x = -1; x <= 1; ++x) *found++ = find(BlockKey::of({c.x + x, c.y + y, c.z + z}));
  }

  WEIR_HD int find(std::uint64_t key) const {
    std::int64_t first = 0, last = keys.size;
    while (first < last) {
      const std::int64_t middle = first + (last - first) / 2;
      if (keys[middle] < key)
        first = middle + 1;
      else
        last = middle;
    }
    return first < keys.size && keys[first] == key ? static_cast<int>(first) : -1;
  }
};

}  // namespace

template <class Backend>
void SparseGrid::connectOn(Backend& device) {
  parallelFor(device, "surface neighbors", blocks_, FindAround{{keys_.data(), blocks_}, around_.view()});
}

template void SparseGrid::connectOn(ThisBackend&);

}  // namespace weir
