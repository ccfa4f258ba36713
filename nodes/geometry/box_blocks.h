// The boxes of a tree's triangles in blocks of eight, those of the blocks in blocks again, and so on up to
// one block: a tree with eight branches, whose boxes the CPU tests eight at a time.
//
// Triangles are in the order of the leaves, so neighbours in memory are neighbours in space.
#pragma once

#include <bit>

#include "framework/compute/eight.h"
#include "framework/graph/memory_estimate.h"
#include "nodes/geometry/triangle_tree.h"

#ifdef WEIR_HAS_LANES

namespace weir {

class BoxBlocks {
 public:
  /// Meshes of more triangles are not worth it: making the blocks would take longer than walks down the tree.
  static constexpr std::int64_t kMostTriangles = 1 << 16;

  /// Of the present triangles; empty if they are too many. In O(n), some ten nanoseconds a triangle.
  BoxBlocks(CpuBackend& device, const TriangleTreeView& tree) : boxes_(device) {
    std::int64_t count = tree.triangles.size, blocks = 0;
    if (count == 0 || count > kMostTriangles) return;
    do {
      first_[levels_++] = blocks;
      count = (count + kEight - 1) / kEight;
      blocks += count;
    } while (count > 1);
    boxes_.resize(blocks);
    first_[levels_] = blocks;
    for (int level = 0; level < levels_; ++level)
      parallelFor(device, "boxes", first_[level + 1] - first_[level],
                  [&](std::int64_t b) { level == 0 ? boxTriangles(tree, b) : boxBlocks(level, b); });
  }

  /// Bytes on the device for a tree of so many triangles, at most.
  static double mostMemory(std::size_t triangles) {
    // Each level has an eighth of the blocks of the one below, rounded up.
    const double blocks = static_cast<double>(triangles) / (kEight - 1) + kMostLevels;
    return triangles > std::size_t{kMostTriangles} ? 0 : bytesOfArray(blocks, sizeof(Block));
  }

  /// As TriangleTreeView::forEachTriangleNear, with the same triangles in the same order.
  template <class F>
  void forEachTriangleNear(const TriangleTreeView& tree, const Vec3f& p, float radius, F&& f) const {
    int found[kMostFound + kEight];
    const int count = levels_ > 0 ? near(p, radius, found) : kMostFound + 1;
    if (count > kMostFound) return tree.forEachTriangleNear(p, radius, f);
    for (int k = 0; k < count; ++k) {
      const detail::TreeTriangle t = tree.triangles[found[k]];
      f(t.a, t.b, t.c);
    }
  }

 private:
  static constexpr int kMostLevels = 8;
  static constexpr int kMostFound = 256;
  static constexpr float kFar = 1e18f;

  struct Block {
    float lo[3][kEight], hi[3][kEight];

    void set(int lane, const Aabb& box) {
      for (int axis = 0; axis < 3; ++axis) lo[axis][lane] = box.lo[axis], hi[axis][lane] = box.hi[axis];
    }
    Aabb all() const {
      Aabb box{{kFar, kFar, kFar}, {-kFar, -kFar, -kFar}};
      for (int lane = 0; lane < kEight; ++lane)
        box.extend(Aabb{{lo[0][lane], lo[1][lane], lo[2][lane]}, {hi[0][lane], hi[1][lane], hi[2][lane]}});
      return box;
    }
    /// Bit l says whether box l is within √reach of p, by the same arithmetic as WalkNear.
    unsigned near(const Vec3f& p, float reach) const {
      Vec3<Lanes> out;
      for (int axis = 0; axis < 3; ++axis) {
        const Lanes below = Lanes::load(lo[axis]) - p[axis], above = p[axis] - Lanes::load(hi[axis]);
        out[axis] = positivePart(select(below < above, above, below));
      }
      return ~(Lanes(reach) < dot(out, out)).bits() & 0xffu;
    }
  };

  /// An empty box is near nothing.
  static Aabb emptyBox() { return {{kFar, kFar, kFar}, {-kFar, -kFar, -kFar}}; }

  void boxTriangles(const TriangleTreeView& tree, std::int64_t b) {
    Block& block = boxes_.data()[b];
    for (int lane = 0; lane < kEight; ++lane) {
      const std::int64_t i = b * kEight + lane;
      if (i >= tree.triangles.size) {
        block.set(lane, emptyBox());
        continue;
      }
      const detail::TreeTriangle t = tree.triangles[i];
      block.set(lane, {min(min(t.a, t.b), t.c), max(max(t.a, t.b), t.c)});
    }
  }

  void boxBlocks(int level, std::int64_t b) {
    const Block* below = boxes_.data() + first_[level - 1];
    const std::int64_t count = first_[level] - first_[level - 1];
    Block& block = boxes_.data()[first_[level] + b];
    for (int lane = 0; lane < kEight; ++lane) {
      const std::int64_t i = b * kEight + lane;
      block.set(lane, i < count ? below[i].all() : emptyBox());
    }
  }

  /// Writes the indices of the near triangles, ascending; returns how many, kMostFound + 1 if there are more.
  int near(const Vec3f& p, float radius, int* found) const {
    const float reach = radius * radius * (1 + 1e-6f);
    struct {
      int block;
      unsigned bits;  // of the boxes that are still to be looked into
    } open[kMostLevels];
    int level = levels_ - 1, count = 0;
    open[level] = {0, boxes_.data()[first_[level]].near(p, reach)};
    if (level == 0) return storeChosen(found, LaneInts::from(0), open[0].bits);
    while (level < levels_) {
      auto& at = open[level];
      if (at.bits == 0) {
        ++level;
        continue;
      }
      const int child = at.block * kEight + std::countr_zero(at.bits);
      at.bits &= at.bits - 1;
      const unsigned bits = boxes_.data()[first_[level - 1] + child].near(p, reach);
      if (level > 1) {
        open[--level] = {child, bits};
        continue;
      }
      count += storeChosen(found + count, LaneInts::from(child * kEight), bits);
      if (count > kMostFound) return kMostFound + 1;
    }
    return count;
  }

  Array<Block> boxes_;
  int levels_ = 0;
  std::int64_t first_[kMostLevels + 1] = {};  // block of each level, the triangles' first
};

}  // namespace weir

#endif
