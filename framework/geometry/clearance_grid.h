// How far points are from a rigid mesh at least, in one look-up: most points have nothing near them, and the
// tree need not be asked.
#pragma once

#include <cstdint>

#include "framework/base/api.h"
#include "framework/geometry/triangle_tree.h"

namespace WEIR_API weir {

/// Plain data for kernels; valid as long as its ClearanceGrid. An empty one knows nothing.
struct ClearanceView {
  Aabb bounds;            ///< of the mesh, covered by the cells
  float cell = 0;         ///< edge of a cell, m
  float inverseCell = 0;  ///< 1/m
  float step = 0;         ///< m
  Vec3i cells{0, 0, 0};   ///< along each axis
  /// From the middle of a cell nothing is nearer than that many steps; x runs fastest.
  ArrayView<const std::uint8_t> steps;

  /// No triangle is nearer to p than this, m, up to a few roundings of the coordinates; may be negative. Not
  /// a number where p is none.
  WEIR_HD float at(const Vec3f& p) const {
    if (steps.size == 0) return 0;
    const Vec3f inside = min(max(p, bounds.lo), bounds.hi), from = inverseCell * (inside - bounds.lo);
    const int x = index(from.x, cells.x), y = index(from.y, cells.y), z = index(from.z, cells.z);
    const Vec3f middle = bounds.lo + cell * Vec3f{x + 0.5f, y + 0.5f, z + 0.5f};
    const float stored = steps[(std::int64_t{z} * cells.y + y) * cells.x + x];
    const float clear = stored * step - length(inside - middle);
    // What is in the box and not near `inside` is beyond a right angle at it.
    const Vec3f out = p - inside;
    const float squared = dot(out, out);
    if (squared == 0) return clear;
    return std::sqrt(squared + (clear > 0 ? clear * clear : 0));
  }

  /// Whether certainly nothing is as near to the segment from p to q as `margin`.
  WEIR_HD bool clears(const Vec3f& p, const Vec3f& q, float margin) const {
    // The distance changes by no more than the way. Mostly the first look-up is enough.
    const float way = length(q - p), clear = at(q);
    return clear > way + margin || clear + at(p) > way + 2 * margin;
  }

 private:
  WEIR_HD static int index(float at, int count) {
    const float last = static_cast<float>(count - 1);
    return static_cast<int>(at > 0 ? (at < last ? at : last) : 0.0f);
  }
};

/// Owns the look-up table.
class ClearanceGrid {
 public:
  ClearanceGrid() = default;  ///< empty
  /// Cells of the edge `finest` (m, above 0) at least, larger where it would take more than kMaxCells. Asks
  /// the tree, on its device, for cells near the mesh.
  ClearanceGrid(Device& device, const TriangleTreeView& tree, float finest);

  ClearanceView view() const;

  static constexpr std::int64_t kMaxCells = std::int64_t{1} << 23;
  /// Bytes on the device: of the cells, and of the coarser ones while they are filled.
  static constexpr double kMaxMemory = kMaxCells * (1 + 5 * sizeof(float) / 32.0);
  /// Of a mesh in a box of that size, m.
  static double maxMemoryFor(const Vec3f& size, float finest);

 private:
  template <class Backend>
  void fillOn(Backend& device, const TriangleTreeView& tree);

  Aabb bounds_;
  float cell_ = 0, step_ = 0;
  Vec3i cells_{0, 0, 0};
  Array<std::uint8_t> steps_;
};

}  // namespace weir
