// A grid of nodes that exists only in blocks: what a field costs follows where it is not zero.
//
// Node (i, j, k) stands at cell size times (i, j, k), wherever the fluid is, so the grid does not move with
// it. A block has 8³ nodes, and the 8³ cells whose lower corners they are. What has no block is 0 there.
#pragma once

#include <cstdint>

#include "framework/base/api.h"
#include "framework/base/vec.h"
#include "framework/compute/parallel.h"

namespace WEIR_API weir {

struct BlockKey {
  static constexpr int kSide = 8;  // nodes along each axis of a block
  static constexpr int kNodes = kSide * kSide * kSide;
  static constexpr int kBits = 21;
  static constexpr int kFarthest = (1 << (kBits - 1)) - 2;  // blocks from the origin, along each axis

  /// Ascending in z, then y, then x; for coordinates up to kFarthest + 1, of either sign.
  WEIR_HD static std::uint64_t of(const Vec3i& block) {
    const auto part = [](int c) { return static_cast<std::uint64_t>(c + (1 << (kBits - 1))); };
    return part(block.z) << (2 * kBits) | part(block.y) << kBits | part(block.x);
  }
  WEIR_HD static Vec3i coordinates(std::uint64_t key) {
    const auto part = [](std::uint64_t bits) {
      return static_cast<int>(bits & ((std::uint64_t{1} << kBits) - 1)) - (1 << (kBits - 1));
    };
    return {part(key), part(key >> kBits), part(key >> (2 * kBits))};
  }
};

/// A field on the grid, as kernels see it.
struct GridView {
  static constexpr int kAround = 27;  // blocks, the middle one included

  float cellSize = 0;
  ArrayView<const std::uint64_t> keys;  ///< of the blocks, ascending
  ArrayView<const int> around;    ///< 27 of each block: their numbers, x fastest; −1 where there is none
  ArrayView<const float> values;  ///< 512 of each block, x fastest

  WEIR_HD static int local(const Vec3i& c) { return (c.z * BlockKey::kSide + c.y) * BlockKey::kSide + c.x; }
  WEIR_HD static Vec3i coordinates(int local) { return {local & 7, local >> 3 & 7, local >> 6}; }

  /// The number of a node, or −1 if it has no block; coordinates count from the block's own lower corner and
  /// may be from −8 to 15.
  WEIR_HD std::int64_t node(std::int64_t block, const Vec3i& c) const {
    if (((c.x | c.y | c.z) & ~7) == 0) return block * BlockKey::kNodes + local(c);
    const int side = ((c.z + 8) >> 3) * 9 + ((c.y + 8) >> 3) * 3 + ((c.x + 8) >> 3);
    const std::int64_t other = around[block * kAround + side];
    return other < 0 ? -1 : other * BlockKey::kNodes + local({c.x & 7, c.y & 7, c.z & 7});
  }
  WEIR_HD float value(std::int64_t block, const Vec3i& c) const {
    const std::int64_t n = node(block, c);
    return n < 0 ? 0.0f : values[n];
  }
  /// By central differences, per cell.
  WEIR_HD Vec3f gradient(std::int64_t block, const Vec3i& c) const {
    Vec3f g;
    for (int axis = 0; axis < 3; ++axis) {
      Vec3i before = c, after = c;
      --before[axis], ++after[axis];
      g[axis] = (value(block, after) - value(block, before)) / 2;
    }
    return g;
  }
};

class SparseGrid {
 public:
  explicit SparseGrid(Device& device) : keys_(device), around_(device), values_(device) {}

  float cellSize() const { return cellSize_; }
  std::int64_t blocks() const { return blocks_; }
  GridView view() const { return {cellSize_, {keys_.data(), blocks_}, around_.view(), values_.view()}; }

  /// Room for that many blocks, whose keys and values are then undefined.
  void resize(float cellSize, std::int64_t blocks);
  /// The keys must be different and ascending.
  Array<std::uint64_t>& keys() { return keys_; }
  Array<float>& values() { return values_; }
  const Array<std::uint64_t>& keys() const { return keys_; }
  const Array<float>& values() const { return values_; }
  /// Finds which blocks are side by side; once the keys are there.
  void connect(Device& device);

 private:
  template <class Backend>
  void connectOn(Backend& device);

  float cellSize_ = 0;
  std::int64_t blocks_ = 0;
  Array<std::uint64_t> keys_;
  Array<int> around_;
  Array<float> values_;
};

}  // namespace weir
