#include "framework/neighbors/cell_grid.h"

#include <algorithm>
#include <array>

namespace weir {

namespace {

/// The cells along one axis of a box that would need more.
///
/// Much of a fluid is at the ends of its box: two splashes that fly apart are. Where the box is a whole
/// number of grids and a bit long, its far end would share the cells of its near end. So the box is made to
/// end far in the last grid, with room on both sides.
class Axis {
 public:
  explicit Axis(double needed) : needed_(std::clamp(needed, kMin, kMax)), cells_(needed_) {}

  double cells() const { return cells_; }
  /// One more grid fits into the box.
  void shrink() {
    turns_ = std::max(turns_ + 1, std::floor(kGrowth * turns_));
    cells_ = std::max(kMin, bestNear(std::floor(needed_ / (turns_ + kEnd))));
  }
  void enlarge() { cells_ *= 2; }
  /// To that many cells, but no fewer than half of the box.
  void cut(double max) {
    cells_ = std::max({kMin, std::ceil(0.5 * needed_), std::min(cells_, std::floor(max))});
  }

 private:
  static constexpr double kMin = CellGrid::kMinCells;
  static constexpr double kMax = 1e12;     // more than CellGrid::cellOf tells apart
  static constexpr double kEnd = 0.8;      // in the last grid
  static constexpr double kGrowth = 1.02;  // so that the longest boxes are no matter of millions of steps

  /// Where the box is many grids long, one cell more or less moves its end far.
  double bestNear(double max) const {
    constexpr double kMinShare = 0.8;
    constexpr int kTries = 32;
    double best = max, bestError = 1;
    for (double cells = max; cells > max - kTries && cells >= std::max(kMin, kMinShare * max); --cells) {
      const double error = std::abs(needed_ / cells - std::floor(needed_ / cells) - kEnd);
      if (error < bestError) best = cells, bestError = error;
    }
    return best;
  }

  double needed_, cells_, turns_ = 0;
};

/// How far the mean of points is from the middle of their box: 0 to 1/2 of it, along one axis.
double offCenter(double mean, double low, double high) {
  return high > low ? std::abs((mean - low) / (high - low) - 0.5) : 0.0;
}

}  // namespace

CellGrid chooseCellGrid(const Aabb& box, float cellSize, std::int64_t maxCells, std::int64_t fewestCells,
                        const std::optional<Vec3f>& mean) {
  CellGrid grid;
  grid.inverseCellSize = 1.0f / cellSize;
  std::array<Axis, 3> axes{Axis(0), Axis(0), Axis(0)};
  // Two cells more than the box, so that its two ends do not become neighbours.
  for (int k = 0; k < 3 && !box.empty(); ++k) axes[k] = Axis(std::ceil(double(box.size()[k]) / cellSize) + 3);
  const auto cells = [&] { return axes[0].cells() * axes[1].cells() * axes[2].cells(); };
  const auto shorter = [](const Axis& a, const Axis& b) { return a.cells() < b.cells(); };
  const auto max = double(std::max<std::int64_t>(maxCells, 27));
  if (mean && cells() > max) {
    // Water in a tank: drops fly high above what lies at the bottom. Of points in a box of height 1 whose
    // mean is at m, at most m/c are above c.
    constexpr double kAtOneEnd = 0.25;
    const double off[] = {offCenter(mean->x, box.lo.x, box.hi.x), offCenter(mean->y, box.lo.y, box.hi.y),
                          offCenter(mean->z, box.lo.z, box.hi.z)};
    const auto k = std::max_element(off, off + 3) - off;
    if (off[k] >= kAtOneEnd) axes[std::size_t(k)].cut(max / (cells() / axes[std::size_t(k)].cells()));
  }
  while (cells() > max) std::max_element(axes.begin(), axes.end(), shorter)->shrink();
  while (cells() < double(std::min(fewestCells, maxCells)) / 2)
    std::min_element(axes.begin(), axes.end(), shorter)->enlarge();
  grid.cells = {int(axes[0].cells()), int(axes[1].cells()), int(axes[2].cells())};
  return grid;
}

}  // namespace weir
