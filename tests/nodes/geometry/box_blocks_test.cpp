// Blocks of boxes against walks down the tree.
#include "nodes/geometry/box_blocks.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/support/meshes.h"

#ifdef WEIR_HAS_LANES

namespace weir::test {
namespace {

using Corners = std::vector<Vec3f>;

template <class Triangles>
Corners near(const Triangles& triangles, const TriangleTreeView& tree, const Vec3f& p, float radius) {
  Corners corners;
  triangles.forEachTriangleNear(tree, p, radius, [&](const Vec3f& a, const Vec3f& b, const Vec3f& c) {
    corners.insert(corners.end(), {a, b, c});
  });
  return corners;
}

struct WalksDownTheTree {
  template <class F>
  void forEachTriangleNear(const TriangleTreeView& tree, const Vec3f& p, float radius, F&& f) const {
    tree.forEachTriangleNear(p, radius, f);
  }
};

TEST(BoxBlocks, FindTheSameTrianglesInTheSameOrder) {
  CpuDevice device(2);
  std::mt19937 random(5);
  std::uniform_real_distribution<float> coordinate(-1.5f, 1.5f);
  // Less than a block, a level, three levels; and more than blocks are made for.
  for (const TriangleMesh& mesh : {sheet(1), boxMesh({-1, -1, -1}, {1, 1, 1}), icosphere(3), icosphere(6)}) {
    const TriangleTree tree(device, mesh);
    const BoxBlocks blocks(device, tree.view());
    std::size_t found = 0;
    for (int i = 0; i < 200; ++i) {
      const Vec3f p{coordinate(random), coordinate(random), coordinate(random)};
      // The largest finds more than there is room for.
      for (const float radius : {0.0f, 0.05f, 0.5f, 4.0f}) {
        if (radius > 1 && i > 2) continue;
        const Corners expected = near(WalksDownTheTree{}, tree.view(), p, radius);
        EXPECT_EQ(near(blocks, tree.view(), p, radius), expected) << mesh.triangles.size() << ", " << radius;
        found += expected.size();
      }
    }
    EXPECT_GT(found, 0u);
  }
}

TEST(BoxBlocks, OfNoTrianglesFindNone) {
  CpuDevice device(1);
  const TriangleTree tree;
  const BoxBlocks blocks(device, tree.view());
  EXPECT_TRUE(near(blocks, tree.view(), {}, 1).empty());
}

}  // namespace
}  // namespace weir::test

#endif
