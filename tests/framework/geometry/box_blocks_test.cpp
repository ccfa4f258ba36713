// Blocks of boxes against walks down the tree.
#include "framework/geometry/box_blocks.h"

#include <gtest/gtest.h>

#include <random>

#include "framework/geometry/triangle_tree.h"
#include "tests/support/meshes.h"

#ifdef WEIR_HAS_LANES

namespace weir::test {
namespace {

constexpr int kMax = 300;

std::vector<int> byWalk(const TriangleTreeView& tree, const Vec3f& p, float radius) {
  std::vector<int> found(kMax + 1);
  found.resize(static_cast<std::size_t>(WalkNear(tree, p, radius).next(found.data(), kMax + 1)));
  return found;
}

TEST(BoxBlocks, FindTheSameTrianglesInTheSameOrder) {
  CpuDevice device(2);
  std::mt19937 random(5);
  std::uniform_real_distribution<float> coordinate(-1.5f, 1.5f);
  // Less than a block, a level, three levels, and six.
  for (const TriangleMesh& mesh : {sheet(1), boxMesh({-1, -1, -1}, {1, 1, 1}), icosphere(3), icosphere(6)}) {
    const TriangleTree tree(device, mesh);
    const TriangleTreeView view = tree.view();
    ASSERT_NE(view.blocks, nullptr);
    std::size_t found = 0, tooMany = 0;
    for (int i = 0; i < 200; ++i) {
      const Vec3f p{coordinate(random), coordinate(random), coordinate(random)};
      for (const float radius : {0.0f, 0.05f, 0.5f, 4.0f}) {
        if (radius > 1 && i > 2) continue;
        const std::vector<int> expected = byWalk(view, p, radius);
        std::vector<int> near(kMax + Lanes::kCount);
        const int count = view.blocks->near(p, radius, near.data(), kMax);
        ASSERT_EQ(static_cast<std::size_t>(count), expected.size())
            << mesh.triangles.size() << ", " << radius;
        found += expected.size();
        if (count > kMax) {
          ++tooMany;
          continue;
        }
        near.resize(static_cast<std::size_t>(count));
        EXPECT_EQ(near, expected) << mesh.triangles.size() << ", " << radius;
      }
    }
    EXPECT_GT(found, 0u);
    EXPECT_EQ(tooMany > 0, mesh.triangles.size() > kMax);
  }
}

TEST(BoxBlocks, SayWhenThereIsNoRoomForAll) {
  CpuDevice device(1);
  const BoxBlocks blocks(device, std::vector<Aabb>(5, Aabb{{0, 0, 0}, {1, 1, 1}}));
  int near[3 + Lanes::kCount];
  EXPECT_EQ(blocks.near({0, 0, 0}, 1, near, 3), 4);
  EXPECT_EQ(blocks.near({0, 0, 0}, 1, near, 5), 5);
}

TEST(BoxBlocks, OfNoTrianglesFindNone) {
  CpuDevice device(1);
  const BoxBlocks blocks(device, {});
  int near[Lanes::kCount];
  EXPECT_EQ(blocks.near({}, 1, near, 0), 0);
}

}  // namespace
}  // namespace weir::test

#endif
