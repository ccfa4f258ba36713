// Which of many solids may be near a place, found once for all who ask: a grid that wraps around in space,
// whose cells have a bit for each solid. A solid has one in every cell that its ball reaches. So what a
// particle asks follows the solids that are near it; they come in their order and each once, whatever the
// number of threads; and whoever asks these alone finds what it would among all, to the bit.
#pragma once

#include <cstdint>
#include <vector>

#include "framework/base/api.h"
#include "framework/compute/atomics.h"
#include "framework/compute/parallel.h"
#include "framework/solids/solid.h"

namespace WEIR_API weir {

/// Numbers of solids, in ascending order: for (int k = near.from(0); k < near.count; k = near.from(k + 1)).
struct NearSolids {
  int count = 0;                        ///< of all solids
  const std::uint32_t* cell = nullptr;  ///< null: all of them

  /// The first from k on; `count` if there is none.
  WEIR_HD int from(int k) const {
    if (cell == nullptr || k >= count) return k;
    const std::uint32_t groups = cell[0];
    if (groups == 0) return count;
    std::uint32_t mask = ~std::uint32_t{0} << (k % kBits);
    for (int word = k / kBits; word * kBits < count; ++word, mask = ~std::uint32_t{0}) {
      if ((groups >> (word % kBits) & 1u) == 0) continue;
      const std::uint32_t bits = cell[1 + word] & mask;
      if (bits != 0) return word * kBits + lowestBit(bits);
    }
    return count;
  }

  static constexpr int kBits = 32;  // of a word
};

/// For kernels. An empty one knows nothing: all solids may be near.
struct SolidGridView {
  int words = 0;  ///< of a cell: one whose bit b tells of the words b, b + 32, … of solids behind it
  int along = 0;  ///< cells along each axis, a power of two
  float inverseEdge = 1;  ///< of a cell, 1/m
  float way = 0;          ///< m: farther, nobody goes who asks the grid
  ArrayView<std::uint32_t> bits;

  static constexpr float kFarthest = 1e8f;  // cells from the origin, far below the largest integer

  WEIR_HD std::int64_t wordOf(int x, int y, int z) const {
    const int last = along - 1;
    return ((std::int64_t{z & last} * along + (y & last)) * along + (x & last)) * words;
  }

  /// The solids that may be near somebody who has come to p, in a straight line of `length` m.
  WEIR_HD NearSolids near(const Vec3f& p, float length, std::int64_t all) const {
    const auto count = static_cast<int>(all);
    if (bits.size == 0) return {count};
    const Vec3f at = inverseEdge * p;
    const bool known = fabsf(at.x) < kFarthest && fabsf(at.y) < kFarthest && fabsf(at.z) < kFarthest;
    if (!known || !(length <= way)) return {count};
    return {count, bits.data + wordOf(cellOf(at.x), cellOf(at.y), cellOf(at.z))};
  }

  WEIR_HD static int cellOf(float at) { return static_cast<int>(floorf(at)); }
};

/// Owns the cells.
class SolidGrid {
 public:
  explicit SolidGrid(Device& device) : bits_(device) {}

  /// From now on for these solids, and for things within `reach` m of them, which go at most `way` m a step
  /// and are stopped `gap` m before them. Few solids need no grid.
  void fit(const std::vector<SolidView>& solids, float reach, float way, float gap);
  /// Whenever solids have moved.
  template <class Backend>
  void sort(Backend& device, ArrayView<const SolidView> solids);
  SolidGridView view() const { return view_; }

  /// Bytes for that many solids.
  static double memoryFor(std::int64_t solids);

 private:
  static constexpr std::int64_t kFew = 16;  // solids; asking them all is as cheap
  static constexpr int kAlong = 32;

  static int wordsFor(std::int64_t solids);

  Array<std::uint32_t> bits_;
  SolidGridView view_;
  float reach_ = 0, gap_ = 0;
};

namespace detail {

/// Sets the bits of solid i / along in a layer of cells.
struct MarkCells {
  ArrayView<const SolidView> solids;
  SolidGridView grid;
  float reach, gap;

  struct Ball {
    Vec3f center;
    float radius;
    bool known;
  };

  WEIR_HD void operator()(std::int64_t i) const {
    const auto k = static_cast<int>(i / grid.along), layer = static_cast<int>(i % grid.along);
    const Ball ball = ballOf(solids[k]);
    const float cells = grid.inverseEdge * ball.radius;
    const Vec3f at = grid.inverseEdge * ball.center;
    const float most = SolidGridView::kFarthest - cells;
    const bool known = ball.known && fabsf(at.x) < most && fabsf(at.y) < most && fabsf(at.z) < most;
    const Range x = known ? rangeOf(at.x, cells) : all(), y = known ? rangeOf(at.y, cells) : all(),
                z = known ? rangeOf(at.z, cells) : all();
    if (layer >= z.count) return;
    for (int b = 0; b < y.count; ++b)
      for (int a = 0; a < x.count; ++a) {
        const Vec3i cell{x.first + a, y.first + b, z.first + layer};
        if (x.wraps || y.wraps || z.wraps || isReached(cell, at, cells)) mark(cell, k);
      }
  }

 private:
  /// Of cells along an axis.
  struct Range {
    int first, count;
    bool wraps;  // all of them
  };
  WEIR_HD Range all() const { return {0, grid.along, true}; }
  WEIR_HD Range rangeOf(float at, float cells) const {
    const int first = SolidGridView::cellOf(at - cells), last = SolidGridView::cellOf(at + cells);
    if (last - first + 1 >= grid.along) return all();
    return {first, last - first + 1, false};
  }

  WEIR_HD static bool isReached(const Vec3i& cell, const Vec3f& at, float cells) {
    const Vec3f lo{static_cast<float>(cell.x), static_cast<float>(cell.y), static_cast<float>(cell.z)};
    const Vec3f out = at - min(max(at, lo), lo + Vec3f{1, 1, 1});
    return dot(out, out) <= cells * cells;
  }

  WEIR_HD void mark(const Vec3i& cell, int k) const {
    constexpr int kBits = NearSolids::kBits;
    std::uint32_t* const words = grid.bits.data + grid.wordOf(cell.x, cell.y, cell.z);
    atomicOr(words, std::uint32_t{1} << (k / kBits % kBits));
    atomicOr(words + 1 + k / kBits, std::uint32_t{1} << (k % kBits));
  }

  /// Who is at the end of the step outside of this ball, is farther than `reach` from the mesh then, and
  /// has been farther than `gap` from it on a way of at most `grid.way`: in the mesh's frame that way is at
  /// most longer by what the mesh's box moves and turns.
  WEIR_HD Ball ballOf(const SolidView& solid) const {
    const Aabb& box = solid.clearance.bounds;
    const Vec3f middle = 0.5f * (box.lo + box.hi), center = solid.end.toWorld(middle);
    const float half = 0.5f * length(box.hi - box.lo);
    float radius = half + reach;
    bool known = solid.clearance.steps.size > 0;
    const auto follow = [&](const Pose& from) {
      const float turn = turnBetween(from.rotation, solid.end.rotation);
      const float moves = grid.way + length(center - from.toWorld(middle));
      known = known && turn < 0.5f;
      const float swept = (half + gap + moves * (1 + turn)) / (1 - turn);
      radius = swept > radius ? swept : radius;
    };
    follow(solid.begin);
    follow(solid.predicted);
    // Far above the rounding of all coordinates that are compared.
    constexpr float kRounding = 2e-5f;
    return {center, radius + kRounding * (radius + length(center) + length(middle)), known};
  }

  /// A turn moves a point by at most this times its distance.
  WEIR_HD static float turnBetween(const Quatf& p, const Quatf& q) {
    const float w = q.w - p.w, x = q.x - p.x, y = q.y - p.y, z = q.z - p.z;
    return 2 * std::sqrt(w * w + x * x + y * y + z * z);
  }
};

}  // namespace detail

template <class Backend>
void SolidGrid::sort(Backend& device, ArrayView<const SolidView> solids) {
  if (view_.bits.size == 0) return;
  bits_.fillZero();
  parallelFor(device, "cells of solids", solids.size * view_.along,
              detail::MarkCells{solids, view_, reach_, gap_});
}

}  // namespace weir
