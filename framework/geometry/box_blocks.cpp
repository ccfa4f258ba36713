#include "framework/geometry/box_blocks.h"

#include <algorithm>

#include "framework/graph/memory_estimate.h"

namespace weir {

/// Boxes that nothing is near.
BoxBlocks::Block::Block() {
  for (int axis = 0; axis < 3; ++axis) {
    std::fill(std::begin(lo[axis]), std::end(lo[axis]), kFar);
    std::fill(std::begin(hi[axis]), std::end(hi[axis]), -kFar);
  }
}

void BoxBlocks::Block::set(int lane, const Aabb& box) {
  for (int axis = 0; axis < 3; ++axis) lo[axis][lane] = box.lo[axis], hi[axis][lane] = box.hi[axis];
}

Aabb BoxBlocks::Block::all() const {
  Aabb box{{kFar, kFar, kFar}, {-kFar, -kFar, -kFar}};
  for (int lane = 0; lane < kEightBoxes; ++lane)
    box.extend(Aabb{{lo[0][lane], lo[1][lane], lo[2][lane]}, {hi[0][lane], hi[1][lane], hi[2][lane]}});
  return box;
}

BoxBlocks::BoxBlocks(Device& device, const std::vector<Aabb>& boxes) : blocks_(device) {
  std::vector<Block> blocks;
  std::vector<Aabb> below = boxes;
  while (!below.empty() && (levels_ == 0 || below.size() > 1)) {
    first_[levels_++] = static_cast<std::int64_t>(blocks.size());
    std::vector<Aabb> around;
    for (std::size_t begin = 0; begin < below.size(); begin += kEightBoxes) {
      Block block;
      const std::size_t end = std::min(begin + kEightBoxes, below.size());
      for (std::size_t i = begin; i < end; ++i) block.set(static_cast<int>(i - begin), below[i]);
      blocks.push_back(block);
      around.push_back(block.all());
    }
    below = std::move(around);
  }
  blocks_.assign(blocks);
}

double BoxBlocks::maxMemory(std::size_t triangles) {
  // Each level has an eighth of the blocks of the one below, rounded up.
  return bytesOfArray(static_cast<double>(triangles) / (kEightBoxes - 1) + kMaxLevels, sizeof(Block));
}

}  // namespace weir
