// What the look-up of clearances promises, against the distance to every triangle.
#include "framework/geometry/clearance_grid.h"
#include "framework/compute/dispatch.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "tests/framework/geometry/clearance_grid_kernel.h"
#include "tests/support/devices.h"
#include "tests/support/meshes.h"

namespace weir::test {
namespace {

using ClearanceGridTest = OnDevice;

std::vector<Vec3f> randomPoints(int count, float reach) {
  std::mt19937 random(17);
  std::uniform_real_distribution<float> coordinate(-reach, reach);
  std::vector<Vec3f> points;
  for (int i = 0; i < count; ++i)
    points.push_back({coordinate(random), coordinate(random), coordinate(random)});
  return points;
}

std::vector<float> clearances(Device& device, const TriangleMesh& mesh, float finest,
                              const std::vector<Vec3f>& asked) {
  const TriangleTree tree(device, mesh);
  const ClearanceGrid grid(device, tree.view(), finest);
  const Array<Vec3f> points(device, asked);
  Array<float> out(device, points.size());
  dispatch(device, [&](auto& d) { lookUpClearances(d, grid.view(), points.view(), out.view()); });
  return out.toHost();
}

/// Never above the distance; near the mesh below it by two ways from the middle of a cell at most, and where
/// the bounds are far, not much less than the distance to them.
TEST_P(ClearanceGridTest, AreBelowTheDistanceByLessThanTheCells) {
  TriangleMesh floorAndBall = icosphere(2, 0.2f);
  append(floorAndBall, sheet(1), {0, 0, -0.7f});
  for (const TriangleMesh& mesh :
       {icosphere(2), sheet(3), boxMesh({-1, -0.5f, -0.2f}, {0.3f, 1, 0.7f}), floorAndBall})
    for (const float cell : {0.03f, 0.2f, 5.0f})
      for (const float reach : {1.1f, 30.0f}) {
        const std::vector<Vec3f> asked = randomPoints(500, reach);
        const std::vector<float> found = clearances(*device, mesh, cell, asked);
        for (std::size_t i = 0; i < asked.size(); ++i) {
          const double distance = slowDistance(mesh, asked[i]);
          ASSERT_LE(found[i], distance + 1e-6 * (1 + distance)) << i << " of cells of " << cell;
          const double exact = reach < 2 ? std::min(distance, 2.0 * cell) : 0.9 * (distance - 2);
          ASSERT_GT(found[i], exact - (1.733 + 1.0 / 32) * cell) << i << " of cells of " << cell;
        }
      }
}

TEST_P(ClearanceGridTest, HasABoundedNumberOfCells) {
  const TriangleMesh mesh = boxMesh({-1000, -1000, -1000}, {1000, 1000, 1000});
  const TriangleTree tree(*device, mesh);
  const ClearanceView view = ClearanceGrid(*device, tree.view(), 1e-3f).view();
  EXPECT_LE(view.steps.size, ClearanceGrid::kMaxCells);
  EXPECT_GT(view.steps.size, ClearanceGrid::kMaxCells / 2);
  EXPECT_GE(view.cell * static_cast<float>(view.cells.x), 2000);
}

TEST_P(ClearanceGridTest, ClearsNoSegmentOfPointsThatAreNoNumbers) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const TriangleTree tree(*device, icosphere(1));
  const ClearanceGrid grid(*device, tree.view(), 0.1f);
  const Array<Vec3f> points(*device, std::vector<Vec3f>{{kNan, 0, 0}, {5, 0, 0}, {0, kNan, kNan}});
  Array<float> out(*device, points.size());
  dispatch(*device, [&](auto& d) { lookUpClearances(d, grid.view(), points.view(), out.view()); });
  const std::vector<float> found = out.toHost();
  EXPECT_FALSE(found[0] > 0);
  EXPECT_NEAR(found[1], 4, 0.2);
  EXPECT_FALSE(found[2] > 0);
}

WEIR_ON_EVERY_DEVICE(ClearanceGridTest);

}  // namespace
}  // namespace weir::test
