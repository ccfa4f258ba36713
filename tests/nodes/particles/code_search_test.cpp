// The search of many particles, which on CUDA writes codes at once, against all pairs of some of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "nodes/particles/neighbor_list.h"
#include "tests/support/devices.h"

namespace weir::test {
namespace {

constexpr Aabb kEverywhere{{-1e30f, -1e30f, -1e30f}, {1e30f, 1e30f, 1e30f}};
constexpr float kRadius = 0.1f;

class CodeSearchTest : public OnDevice {
 protected:
  /// `count` particles in a block that begins at `lo`, about five to a cell, in the grid of another box.
  void search(int count, const Vec3f& lo, const Vec3f& size, const Aabb& gridBox, int capacity) {
    std::mt19937 random(11);
    std::uniform_real_distribution<float> unit(0, 1);
    std::vector<Vec3f> points;
    for (int i = 0; i < count; ++i)
      points.push_back(
          {lo.x + size.x * unit(random), lo.y + size.y * unit(random), lo.z + size.z * unit(random)});
    ParticleBatch batch;
    batch.assign(*device, points, std::vector<Vec3f>(points.size()));
    particles = std::make_unique<ParticleSet>(*device);
    particles->append(batch);
    list = std::make_unique<NeighborList>(*device);
    list->configure(kRadius, capacity);
    list->fitGrid(gridBox, count);
    list->build(*particles, kEverywhere);
  }

  /// Every 97th list, and those at the ends.
  void expectLists() {
    const std::int64_t n = particles->refreshCount();
    const std::vector<Vec3f> at = particles->positions().toHost(n);
    const std::vector<std::vector<int>> lists = list->listsOnHost(n);
    for (std::int64_t i = 0; i < n; i = i == n - 1 ? n : std::min(i + 97, n - 1)) {
      const Vec3f p = at[std::size_t(i)];
      std::vector<int> near, found = lists[std::size_t(i)];
      for (std::int64_t j = 0; j < n; ++j) {
        const Vec3f d = at[std::size_t(j)] - p;
        if (j != i && dot(d, d) < kRadius * kRadius) near.push_back(int(j));
      }
      std::ranges::sort(found);
      ASSERT_EQ(found, near) << "of particle " << i;
    }
  }

  std::unique_ptr<ParticleSet> particles;
  std::unique_ptr<NeighborList> list;
};
WEIR_ON_EVERY_DEVICE(CodeSearchTest);

TEST_P(CodeSearchTest, FindsAllWhereIndicesAreCodes) {
  const Vec3f size{2, 2, 1.7f};
  search(33'333, {0, 0, 0}, size, {{0, 0, 0}, size}, 96);
  EXPECT_EQ(list->eventsOnHost().truncated, 0);
  expectLists();
}

TEST_P(CodeSearchTest, FindsAllThroughWindows) {
  const Vec3f lo{-1.31f, 0.4f, -0.7f}, size{3, 2, 2.3f};
  search(70'001, lo, size, {lo, {1.7f, 2.4f, 1.6f}}, 96);
  EXPECT_EQ(list->eventsOnHost().truncated, 0);
  EXPECT_LT(list->eventsOnHost().wideGroups, 70'001 / kListGroup / 16);
  expectLists();
}

TEST_P(CodeSearchTest, FindsAllWhereTheGridWrapsAroundWithinTheFluid) {
  const Vec3f size{3, 2, 2.3f};
  search(70'001, {0, 0, 0}, size, {{0, 0, 0}, {0.9f, 1.1f, 1}}, 96);
  EXPECT_EQ(list->eventsOnHost().truncated, 0);
  expectLists();
}

TEST_P(CodeSearchTest, CutsOffLongListsAndCountsThem) {
  const Vec3f size{2, 2, 1.7f};
  search(33'333, {0, 0, 0}, size, {{0, 0, 0}, size}, 8);
  const std::vector<int> counts = list->countsOnHost(33'333);
  EXPECT_EQ(*std::ranges::max_element(counts), 8);
  const auto full = std::ranges::count(counts, 8);
  EXPECT_GT(list->eventsOnHost().truncated, 33'333 / 2);
  EXPECT_LE(list->eventsOnHost().truncated, full);
}

}  // namespace
}  // namespace weir::test
