// The grid wraps around, so what is far apart may share cells: how much more that makes the search look at.
#include "framework/neighbors/cell_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace weir {
namespace {

constexpr float kSpacing = 0.01f, kRadius = 1.5f * kSpacing;

void addBlock(std::vector<Vec3f>& points, int side, const Vec3f& corner) {
  for (int z = 0; z < side; ++z)
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x)
        points.push_back(corner + kSpacing * Vec3f{x + 0.5f, y + 0.5f, z + 0.5f});
}

CellGrid gridFor(const std::vector<Vec3f>& points) {
  Aabb box;
  Vec3f sum;
  for (const Vec3f& p : points) box.extend(p), sum += p;
  // As a NeighborList does it for a fluid.
  const auto count = static_cast<std::int64_t>(points.size());
  return chooseCellGrid(box, kRadius, 4 * count, count / 4, (1 / float(count)) * sum);
}

/// Points in the 27 cells around a point, a mean over all points: what a search compares distances with.
double candidates(const std::vector<Vec3f>& points) {
  const CellGrid grid = gridFor(points);
  std::vector<int> in(static_cast<std::size_t>(grid.cellCount()));
  for (const Vec3f& p : points) ++in[static_cast<std::size_t>(grid.index(grid.cellOf(p)))];
  double sum = 0;
  for (const Vec3f& p : points) {
    const Vec3i c = grid.cellOf(p);
    for (int k = 0; k < 27; ++k)
      sum += in[static_cast<std::size_t>(grid.index({CellGrid::step(c.x, k % 3 - 1, grid.cells.x),
                                                     CellGrid::step(c.y, k / 3 % 3 - 1, grid.cells.y),
                                                     CellGrid::step(c.z, k / 9 - 1, grid.cells.z)}))];
  }
  return sum / static_cast<double>(points.size());
}

double ofTwoBlocks(const Vec3f& apart) {
  std::vector<Vec3f> points;
  addBlock(points, 20, {});
  addBlock(points, 20, apart);
  return candidates(points);
}

/// Water at one end of a tank, and drops of it all over the tank.
std::vector<Vec3f> waterWithDrops(const Vec3f& tank, const Vec3f& filled, int drops) {
  std::vector<Vec3f> points;
  const int x = int(filled.x / kSpacing), y = int(filled.y / kSpacing), z = int(filled.z / kSpacing);
  for (int i = 0; i < x * y * z; ++i)
    points.push_back(kSpacing *
                     Vec3f{float(i % x) + 0.5f, float(i / x % y) + 0.5f, float(i / (x * y)) + 0.5f});
  std::mt19937 random(3);
  std::uniform_real_distribution<float> unit(0, 1);
  for (int i = 0; i < drops; ++i)
    points.push_back({tank.x * unit(random), tank.y * unit(random), tank.z * unit(random)});
  return points;
}

TEST(CellGrid, DropsHighAboveWaterDoNotMakeItShareCells) {
  // The tank has more cells than there may be. Which way is up does not matter.
  for (const Vec3f& way : {Vec3f{0, 1, 0}, Vec3f{1, 0, 0}, Vec3f{0, 0, 1}}) {
    const Vec3f flat = Vec3f{1, 1, 1} - way;
    const Vec3f tank = 0.9f * flat + 0.6f * way;
    const Vec3f filled = 0.9f * flat + 0.04f * way;
    const double alone = candidates(waterWithDrops(tank, filled, 0));
    const double withDrops = candidates(waterWithDrops(tank, filled, 200));
    EXPECT_LT(withDrops, 1.02 * alone) << "up is " << way.x << " " << way.y << " " << way.z;
  }
}

TEST(CellGrid, TwoSplashesFarApartCostWhatTheyCostSideBySide) {
  const double near = ofTwoBlocks({0.3f, 0, 0});
  double max = 0, sum = 0;
  int distances = 0;
  for (float d = 80; d < 120; d += 0.77f)
    for (const Vec3f& direction : {Vec3f{1, 0, 0}, Vec3f{1, 0.3f, 0.7f}, Vec3f{0.01f, 1, 0.01f}}) {
      const double far = ofTwoBlocks(d * direction);
      max = std::max(max, far / near);
      sum += far / near;
      ++distances;
    }
  RecordProperty("mean", std::to_string(sum / distances));
  RecordProperty("most", std::to_string(max));
  std::printf("candidates of two blocks 100 m apart over those side by side: mean %.3f, most %.3f\n",
              sum / distances, max);
  EXPECT_LE(max, 1.1);
}

TEST(CellGrid, ABlockInAWideSprayCostsLittleMore) {
  std::vector<Vec3f> points;
  addBlock(points, 30, {});
  const double alone = candidates(points);
  std::mt19937 random(1);
  std::uniform_real_distribution<float> place(-50, 50);
  for (int k = 0; k < 300; ++k) points.push_back({place(random), place(random), place(random)});
  EXPECT_LE(candidates(points), 1.1 * alone);
}

TEST(CellGrid, HasCellsForItsPointsNotForItsVolume) {
  std::vector<Vec3f> points;
  addBlock(points, 10, {});
  addBlock(points, 10, {1000, 1000, 1000});
  const CellGrid grid = gridFor(points);
  EXPECT_LE(grid.cellCount(), 4 * 2000);
  EXPECT_GE(grid.cellCount(), 2000 / 4 / 2);
  for (int axis = 0; axis < 3; ++axis) EXPECT_GE(grid.cells[axis], CellGrid::kMinCells);
}

}  // namespace
}  // namespace weir
