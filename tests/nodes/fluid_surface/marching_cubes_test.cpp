#include "nodes/fluid_surface/marching_cubes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <set>

#include "tests/nodes/fluid_surface/host_mesh.h"
#include "tests/support/devices.h"

namespace weir {
namespace {

/// A grid of side³ blocks from the given one on, with values of a function of the node; 0 at its outermost
/// nodes.
SparseGrid filledGrid(Device& device, int side, const Vec3i& first, float cellSize,
                      const std::function<float(const Vec3i& node)>& value) {
  std::vector<std::uint64_t> keys;
  std::vector<float> values;
  const int nodes = side * BlockKey::kSide;
  for (int bz = 0; bz < side; ++bz)
    for (int by = 0; by < side; ++by)
      for (int bx = 0; bx < side; ++bx) {
        keys.push_back(BlockKey::of(first + Vec3i{bx, by, bz}));
        for (int n = 0; n < BlockKey::kNodes; ++n) {
          const Vec3i in = GridView::coordinates(n);
          const Vec3i c{8 * bx + in.x, 8 * by + in.y, 8 * bz + in.z};
          const bool outermost =
              c.x == 0 || c.y == 0 || c.z == 0 || c.x == nodes - 1 || c.y == nodes - 1 || c.z == nodes - 1;
          values.push_back(outermost ? 0 : value({8 * first.x + c.x, 8 * first.y + c.y, 8 * first.z + c.z}));
        }
      }
  SparseGrid grid(device);
  grid.resize(cellSize, std::ssize(keys));
  grid.keys().assign(keys);
  grid.values().assign(values);
  grid.connect(device);
  return grid;
}

TriangleMesh meshOf(Device& device, const SparseGrid& grid, float level) {
  DynamicMesh mesh{Array<Vec3f>(device), Array<Vec3f>(device), Array<Vec3i>(device)};
  MarchingCubes(device).extract(device, grid, level, mesh);
  for (const Vec3f& n : mesh.normals.toHost()) EXPECT_NEAR(length(n), 1, 1e-5);
  return test::onHost(mesh);
}

TEST(CubeTable, CrossesExactlyTheEdgesBetweenInsideAndOutside) {
  const CubeTable table = makeCubeTable();
  for (int c = 0; c < 256; ++c) {
    std::set<int> expected, found;
    for (int corner = 0; corner < 8; ++corner)
      for (int axis = 0; axis < 3; ++axis)
        if ((corner >> axis & 1) == 0 && (c >> corner & 1) != (c >> (corner | 1 << axis) & 1))
          expected.insert(3 * corner + axis);
    for (int k = 0; k < 3 * table.triangles[c]; ++k) found.insert(table.edges[c][k]);
    EXPECT_EQ(found, expected) << "case " << c;
  }
}

using MarchingCubesTest = test::OnDevice;

TEST_P(MarchingCubesTest, NoiseIsClosedAndTurnedOutwards) {
  // Every case next to every other, through the borders of blocks, on both sides of the origin.
  for (unsigned seed = 0; seed < 4; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> uniform(0, 1);
    const SparseGrid grid =
        filledGrid(*device, 3, {-2, -1, 0}, 0.1f, [&](const Vec3i&) { return uniform(random); });
    const TriangleMesh mesh = meshOf(*device, grid, seed == 3 ? 0.8f : 0.5f);
    const MeshDiagnosis diagnosis = diagnose(mesh);
    EXPECT_TRUE(diagnosis.good()) << diagnosis.message();
    EXPECT_GT(mesh.triangles.size(), 10000u);
  }
}

TEST_P(MarchingCubesTest, SignsOfValuesAtTheLevelItselfLeaveNoHoles) {
  std::mt19937 random(7);
  const SparseGrid grid =
      filledGrid(*device, 2, {0, 0, 0}, 1, [&](const Vec3i&) { return 0.25f * float(random() % 4); });
  const MeshDiagnosis diagnosis = diagnose(meshOf(*device, grid, 0.5f));
  EXPECT_TRUE(diagnosis.good()) << diagnosis.message();
}

TEST_P(MarchingCubesTest, BallHasItsVolumeAreaAndNormals) {
  const Vec3f center{0.3f, -0.2f, 0.1f};
  const float radius = 9.3f;  // cells
  const SparseGrid grid = filledGrid(*device, 4, {-2, -2, -2}, 1, [&](const Vec3i& n) {
    return std::max(0.0f, 20 - length(Vec3f{float(n.x), float(n.y), float(n.z)} - center));
  });
  DynamicMesh mesh{Array<Vec3f>(*device), Array<Vec3f>(*device), Array<Vec3i>(*device)};
  MarchingCubes(*device).extract(*device, grid, 20 - radius, mesh);
  const TriangleMesh ball = test::onHost(mesh);
  EXPECT_TRUE(diagnose(ball).good()) << diagnose(ball).message();
  EXPECT_EQ(test::eulerCharacteristic(ball), 2);
  // Triangles are as deep below the sphere as chords of √3 cells at most, and touch it at their corners.
  const double depth = 3 / (8 * double(radius));
  const double volume = 4.0 / 3 * M_PI * std::pow(radius, 3), area = 4 * M_PI * radius * radius;
  EXPECT_LT(ball.volume(), volume);
  EXPECT_GT(ball.volume(), volume - area * depth);
  EXPECT_LT(ball.area(), area);
  EXPECT_GT(ball.area(), area * (1 - 2 * depth / double(radius)));
  const std::vector<Vec3f> normals = mesh.normals.toHost();
  for (std::size_t i = 0; i < normals.size(); ++i)
    EXPECT_GT(dot(normals[i], normalized(ball.vertices[i] - center)), 0.999f);
}

TEST_P(MarchingCubesTest, NoBlocksNoMesh) {
  SparseGrid grid(*device);
  EXPECT_TRUE(meshOf(*device, grid, 0.5f).vertices.empty());
}

WEIR_ON_EVERY_DEVICE(MarchingCubesTest);

}  // namespace
}  // namespace weir
