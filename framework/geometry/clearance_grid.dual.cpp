#include <limits>

#include "framework/compute/parallel.h"
#include "framework/geometry/clearance_grid.h"

namespace weir {

namespace {

/// Cells of one size; each but the first has the middle of its parent, twice as large, half an edge away.
struct Level {
  Vec3f lo;
  float cell;  // m
  Vec3i cells;

  WEIR_HD Vec3i place(std::int64_t i) const {
    const std::int64_t row = i / cells.x;
    return {static_cast<int>(i % cells.x), static_cast<int>(row % cells.y), static_cast<int>(row / cells.y)};
  }
  WEIR_HD Vec3f middle(const Vec3i& c) const { return lo + cell * Vec3f{c.x + 0.5f, c.y + 0.5f, c.z + 0.5f}; }
  std::int64_t size() const { return std::int64_t{cells.x} * cells.y * cells.z; }
};

/// Lower bounds of the distance from the middles of cells: exact within a few cells of the mesh; farther
/// away, what follows from the parent's.
struct Measure {
  TriangleTreeView tree;
  Level level;
  Vec3i parents;                  // cells along each axis
  ArrayView<const float> bounds;  // of the parents; empty for the coarsest level

  WEIR_HD float operator()(std::int64_t i) const {
    constexpr float kExact = 2, kOffset = 0.867f;  // in cells; √3/2
    const Vec3i c = level.place(i);
    float atMost = std::numeric_limits<float>::infinity();
    if (bounds.size > 0) {
      const std::int64_t parent = (std::int64_t{c.z / 2} * parents.y + c.y / 2) * parents.x + c.x / 2;
      const float bound = bounds[parent], offset = kOffset * level.cell;
      if (bound > (kExact + kOffset) * level.cell) return bound - offset;
      // Enough where the parent's is exact; elsewhere a bound as good as any.
      atMost = bound + 1.01f * offset;
    }
    const float found = tree.nearest(level.middle(c), atMost).distance;
    // What rounding may take from it, here and where it is read.
    const float low = detail::largestCoordinate(tree.bounds.lo),
                high = detail::largestCoordinate(tree.bounds.hi);
    const float slack = 32 * detail::kEpsilon * ((low > high ? low : high) + level.cell + found);
    return found > slack ? found - slack : 0;
  }
};

struct WriteBounds {
  Measure measure;
  ArrayView<float> out;
  WEIR_HD void operator()(std::int64_t i) const { out[i] = measure(i); }
};

struct WriteSteps {
  Measure measure;
  float step;
  ArrayView<std::uint8_t> out;
  WEIR_HD void operator()(std::int64_t i) const {
    const float steps = measure(i) / step;
    out[i] = static_cast<std::uint8_t>(steps < 255 ? steps : 255.0f);
  }
};

}  // namespace

template <class Backend>
void ClearanceGrid::fillOn(Backend& device, const TriangleTreeView& tree) {
  constexpr float kStepsInCell = 32;
  constexpr int kCoarsest = 8;  // in cells
  step_ = cell_ / kStepsInCell;
  Array<float> parents(device);
  Vec3i parentCells{0, 0, 0};
  for (int scale = kCoarsest; scale > 1; scale /= 2) {
    const auto along = [scale](int count) { return (count + scale - 1) / scale; };
    const Level level{bounds_.lo, scale * cell_, {along(cells_.x), along(cells_.y), along(cells_.z)}};
    Array<float> bounds(device, level.size());
    parallelFor(device, "clearance", bounds.size(),
                WriteBounds{{tree, level, parentCells, std::as_const(parents).view()}, bounds.view()});
    parents.swap(bounds);
    parentCells = level.cells;
  }
  const Level finest{bounds_.lo, cell_, cells_};
  parallelFor(device, "clearance", steps_.size(),
              WriteSteps{{tree, finest, parentCells, std::as_const(parents).view()}, step_, steps_.view()});
}

template void ClearanceGrid::fillOn(ThisBackend&, const TriangleTreeView&);

}  // namespace weir
