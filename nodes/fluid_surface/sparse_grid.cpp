#include "nodes/fluid_surface/sparse_grid.h"

#include "framework/compute/dispatch.h"

namespace weir {

void SparseGrid::resize(float cellSize, std::int64_t blocks) {
  cellSize_ = cellSize;
  blocks_ = blocks;
  keys_.resizeDiscarding(blocks);
  around_.resizeDiscarding(blocks * GridView::kAround);
  values_.resizeDiscarding(blocks * BlockKey::kNodes);
}

void SparseGrid::connect(Device& onDevice) {
  dispatch(onDevice, [&](auto& device) { connectOn(device); });
}

}  // namespace weir
