// The tree on devices against asking every triangle.
#include "framework/geometry/triangle_tree.h"
#include "framework/compute/dispatch.h"

#include <gtest/gtest.h>

#include <random>

#include "framework/base/check.h"
#include "tests/framework/geometry/triangle_tree_kernel.h"
#include "tests/support/devices.h"
#include "tests/support/meshes.h"

namespace weir::test {
namespace {

using TriangleTreeTest = OnDevice;

class RandomPoints {
 public:
  Vec3f operator()(float reach) {
    std::uniform_real_distribution<float> coordinate(-reach, reach);
    return {coordinate(random_), coordinate(random_), coordinate(random_)};
  }
  std::vector<Vec3f> many(int count, float reach) {
    std::vector<Vec3f> points;
    for (int i = 0; i < count; ++i) points.push_back((*this)(reach));
    return points;
  }

 private:
  std::mt19937 random_{7};
};

/// Triangles without any order, of sizes from 2 down to a thousandth, 1 in 50 a sliver.
TriangleMesh mixedSoup(int triangles) {
  RandomPoints random;
  TriangleMesh mesh;
  for (int i = 0; i < triangles; ++i) {
    const Vec3f at = random(1);
    const float size = std::pow(10.0f, -3.0f * static_cast<float>(i % 101) / 100);
    const Vec3f b = size * random(1), c = i % 50 == 0 ? 1.001f * b : size * random(1);
    mesh.vertices.insert(mesh.vertices.end(), {at, at + b, at + c});
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return mesh;
}

/// An ornament of small triangles on a floor of two.
TriangleMesh ornamentOnFloor() {
  TriangleMesh mesh = icosphere(4, 0.01f);
  append(mesh, sheet(1));
  return mesh;
}

double boxDistance(const TriangleMesh& mesh, const Vec3i& t, const Vec3f& p) {
  double squared = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto [lo, hi] =
        std::minmax({mesh.vertices[t.x][axis], mesh.vertices[t.y][axis], mesh.vertices[t.z][axis]});
    const double out = std::max({0.0, static_cast<double>(lo) - p[axis], static_cast<double>(p[axis]) - hi});
    squared += out * out;
  }
  return std::sqrt(squared);
}

NearTriangles slowNear(const TriangleMesh& mesh, const Vec3f& p, double radius) {
  NearTriangles found;
  for (const Vec3i& t : mesh.triangles) {
    if (boxDistance(mesh, t, p) > radius) continue;
    ++found.count;
    found.hash += hashOf(mesh.vertices[t.x], mesh.vertices[t.y], mesh.vertices[t.z]);
  }
  return found;
}

TEST_P(TriangleTreeTest, ReportsTheTrianglesWhoseBoxesAreNearEnoughOnce) {
  RandomPoints random;
  for (const TriangleMesh& mesh : {mixedSoup(2000), ornamentOnFloor(), mixedSoup(1), icosphere(2)}) {
    const TriangleTree tree(*device, mesh);
    for (const float radius : {0.0f, 0.003f, 0.05f, 0.5f}) {
      std::vector<Vec3f> asked = random.many(100, 1.2f);
      for (int i = 0; i < 100; ++i) asked.push_back(mesh.vertices[i % mesh.vertices.size()] + random(0.01f));
      const Array<Vec3f> points(*device, asked);
      Array<NearTriangles> out(*device, points.size());
      dispatch(*device, [&](auto& d) { gatherNear(d, tree.view(), radius, points.view(), out.view()); });
      const std::vector<NearTriangles> found = out.toHost();
      for (std::size_t i = 0; i < asked.size(); ++i) {
        // The random points are on no ball's surface, as the neighbouring radii confirm.
        const NearTriangles expected = slowNear(mesh, asked[i], radius);
        if (slowNear(mesh, asked[i], radius * (1 + 2e-6)).count != expected.count) continue;
        ASSERT_EQ(found[i].count, expected.count) << i << " at radius " << radius;
        ASSERT_EQ(found[i].hash, expected.hash) << i << " at radius " << radius;
      }
    }
  }
}

TEST_P(TriangleTreeTest, MissesNoTriangleThatTouchesTheBall) {
  // Balls whose surface touches a face of the box exactly, if rounding does not get between.
  const TriangleMesh mesh = boxMesh({0.1f, 0.1f, 0.1f}, {0.7f, 0.7f, 0.7f});
  const TriangleTree tree(*device, mesh);
  RandomPoints random;
  for (int i = 0; i < 50; ++i) {
    const Vec3f p{0.4f, 0.4f, 0.7f + std::abs(random(1).x)};
    const Array<Vec3f> points(*device, std::vector<Vec3f>{p});
    Array<NearTriangles> out(*device, 1);
    dispatch(*device, [&](auto& d) { gatherNear(d, tree.view(), p.z - 0.7f, points.view(), out.view()); });
    EXPECT_GE(out.toHost()[0].count, 2);
  }
}

TEST_P(TriangleTreeTest, EmptyTreesReportNothing) {
  for (const bool built : {false, true}) {
    const TriangleTree tree = built ? TriangleTree(*device, TriangleMesh{}) : TriangleTree();
    EXPECT_TRUE(tree.view().empty());
    EXPECT_TRUE(tree.view().bounds.empty());
    const Array<Vec3f> points(*device, std::vector<Vec3f>{{0, 0, 0}});
    Array<NearTriangles> out(*device, 1);
    dispatch(*device, [&](auto& d) { gatherNear(d, tree.view(), 1e30f, points.view(), out.view()); });
    EXPECT_EQ(out.toHost()[0].count, 0);
  }
}

TEST(BoxTree, BoxesHoldTheirTrianglesAndLeavesHoldEachOnce) {
  for (const TriangleMesh& mesh : {mixedSoup(3000), ornamentOnFloor()}) {
    const BoxTree tree = buildBoxTree(mesh);
    std::vector<int> seen(mesh.triangles.size());
    for (const BoxTree::Node& node : tree.nodes) {
      for (int i = node.first; i < node.last; ++i) {
        const Vec3i& t = mesh.triangles[tree.order[i]];
        for (int k = 0; k < 3; ++k) ASSERT_TRUE(node.box.contains(mesh.vertices[t[k]]));
        seen[tree.order[i]] += node.child == 0;
      }
      ASSERT_TRUE(node.child > 0 || node.last - node.first <= BoxTree::kLeaf);
    }
    for (const int times : seen) ASSERT_EQ(times, 1);
  }
}

TEST(BoxTree, AFloorDoesNotBlowUpTheBoxesOfAnOrnament) {
  const TriangleMesh mesh = ornamentOnFloor();
  int large = 0;
  for (const BoxTree::Node& node : buildBoxTree(mesh).nodes) large += node.box.size().x > 0.1f;
  EXPECT_EQ(large, 2);  // the root and the leaf of the floor
}

TEST(BoxTree, NestedTrianglesOfAllSizesStayWithinTheDepth) {
  // Each is a third of the one before, so that one after another could be set apart; then many equal ones.
  TriangleMesh mesh;
  for (int i = 0; i < 1000; ++i) {
    const float size = std::pow(3.0f, static_cast<float>(i < 70 ? -i : -70));
    mesh.vertices.insert(mesh.vertices.end(), {{0, 0, 0}, {size, 0, 0}, {0, size, 0}});
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  EXPECT_NO_THROW(buildBoxTree(mesh));
}

TEST(BoxTree, RefusesVerticesThatAreNotThereOrNoNumbers) {
  TriangleMesh mesh = boxMesh({}, {1, 1, 1});
  mesh.triangles[3].y = 8;
  EXPECT_THROW(buildBoxTree(mesh), InternalError);
  mesh = boxMesh({}, {1, 1, 1});
  mesh.vertices[2].y = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(buildBoxTree(mesh), InternalError);
}

WEIR_ON_EVERY_DEVICE(TriangleTreeTest);

}  // namespace
}  // namespace weir::test
