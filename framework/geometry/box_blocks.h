// The boxes of a tree's triangles in blocks of eight, those of the blocks in blocks again, and so on up to
// one block: a tree with eight branches, whose boxes the CPU tests eight at a time.
//
// Triangles are in the order of the leaves, so neighbours in memory are neighbours in space.
#pragma once

#include <algorithm>
#include <bit>
#include <vector>

#include "framework/base/api.h"
#include "framework/compute/array.h"
#include "framework/compute/lanes.h"

namespace WEIR_API weir {

/// Made once for a mesh; TriangleTree keeps it where the device is the CPU.
class BoxBlocks {
 public:
  static constexpr int kEightBoxes = 8;

  /// Of the boxes of triangles, in the order of the leaves.
  BoxBlocks(Device& device, const std::vector<Aabb>& boxes);

  /// Bytes on the device for that many triangles, at most.
  static double maxMemory(std::size_t triangles);

#ifdef WEIR_HAS_LANES
  /// Writes the indices of the triangles whose boxes are as near to p as `radius`: those that
  /// TriangleTreeView::forEachTriangleNear finds, in the same order. Returns how many, `max` + 1 if there
  /// are more. There must be room for `max` and eight more.
  int near(const Vec3f& p, float radius, int* found, int max) const {
    const float reach = radius * radius * (1 + 1e-6f);
    struct {
      int block;
      unsigned bits;  // of the boxes that are still to be looked into
    } open[kMaxLevels];
    if (levels_ == 0) return 0;
    int level = levels_ - 1, count = 0;
    open[level] = {0, blockAt(level, 0).near(p, reach)};
    if (level == 0) return std::min(storeChosen(found, LaneInts::from(0), open[0].bits), max + 1);
    while (level < levels_) {
      auto& at = open[level];
      if (at.bits == 0) {
        ++level;
        continue;
      }
      const int child = at.block * kEightBoxes + std::countr_zero(at.bits);
      at.bits &= at.bits - 1;
      const unsigned bits = blockAt(level - 1, child).near(p, reach);
      if (level > 1) {
        open[--level] = {child, bits};
        continue;
      }
      count += storeChosen(found + count, LaneInts::from(child * kEightBoxes), bits);
      if (count > max) return max + 1;
    }
    return count;
  }
#endif

 private:
  static constexpr int kMaxLevels = 11;  // of 2³¹ triangles
  static constexpr float kFar = 1e18f;

  struct Block {
    float lo[3][kEightBoxes], hi[3][kEightBoxes];

    Block();
    void set(int lane, const Aabb& box);
    Aabb all() const;
#ifdef WEIR_HAS_LANES
    /// Bit l says whether box l is within √reach of p, by the same arithmetic as WalkNear.
    unsigned near(const Vec3f& p, float reach) const {
      Vec3<Lanes> out;
      for (int axis = 0; axis < 3; ++axis) {
        const Lanes below = Lanes::load(lo[axis]) - p[axis], above = p[axis] - Lanes::load(hi[axis]);
        out[axis] = positivePart(select(below < above, above, below));
      }
      return ~(Lanes(reach) < dot(out, out)).bits() & 0xffu;
    }
#endif
  };

  const Block& blockAt(int level, int b) const {
    return blocks_.data()[first_[level] + b];
  }

  Array<Block> blocks_;
  int levels_ = 0;
  std::int64_t first_[kMaxLevels] = {};  // block of each level, the triangles' first
};

}  // namespace weir
