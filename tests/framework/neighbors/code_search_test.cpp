// The search of many particles, which on CUDA writes codes at once, against all pairs of some of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "framework/neighbors/neighbor_list.h"
#include "tests/support/devices.h"

namespace weir::test {
namespace {

constexpr Aabb kEverywhere{{-1e30f, -1e30f, -1e30f}, {1e30f, 1e30f, 1e30f}};

class CodeSearchTest : public OnDevice {
 protected:
  /// `count` particles in a block that begins at `lo`, in the grid of another box.
  void search(int count, const Vec3f& lo, const Vec3f& size, const Aabb& gridBox, int capacity) {
    std::mt19937 random(11);
    std::uniform_real_distribution<float> unit(0, 1);
    std::vector<Vec3f> points;
    for (int i = 0; i < count; ++i)
      points.push_back(
          {lo.x + size.x * unit(random), lo.y + size.y * unit(random), lo.z + size.z * unit(random)});
    search(points, gridBox, capacity);
  }

  void search(const std::vector<Vec3f>& points, const Aabb& gridBox, int capacity) {
    const auto count = static_cast<std::int64_t>(points.size());
    ParticleBatch batch;
    batch.assign(*device, points, std::vector<Vec3f>(points.size()));
    particles = std::make_unique<ParticleSet>(*device);
    particles->append(batch);
    list = std::make_unique<NeighborList>(*device);
    list->configure(radius, capacity);
    list->fitGrid(gridBox, count);
    list->build(*particles, kEverywhere);
  }

  /// Every 97th list, and those at the ends. Where the grid does not wrap around within the fluid, neighbours
  /// are in the order of their places, whichever search found them.
  void expectLists(bool wraps = false) {
    const std::int64_t n = particles->refreshCount();
    const std::vector<Vec3f> at = particles->positions().toHost(n);
    const std::vector<std::vector<int>> lists = list->listsOnHost(n);
    for (std::int64_t i = 0; i < n; i = i == n - 1 ? n : std::min(i + 97, n - 1)) {
      const Vec3f p = at[std::size_t(i)];
      std::vector<int> near, found = lists[std::size_t(i)];
      for (std::int64_t j = 0; j < n; ++j) {
        const Vec3f d = at[std::size_t(j)] - p;
        if (j != i && dot(d, d) < radius * radius) near.push_back(int(j));
      }
      if (wraps) std::ranges::sort(found);
      ASSERT_EQ(found, near) << "of particle " << i;
    }
  }

  float radius = 0.1f;
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
  expectLists(true);
}

TEST_P(CodeSearchTest, FindsAllWhereTheGridWrapsAroundWithinTheFluid) {
  const Vec3f size{3, 2, 2.3f};
  search(70'001, {0, 0, 0}, size, {{0, 0, 0}, {0.9f, 1.1f, 1}}, 96);
  EXPECT_EQ(list->eventsOnHost().truncated, 0);
  expectLists(true);
}

TEST_P(CodeSearchTest, FindsAllInAGridOfThreeCellsAlongX) {
  // All rows wrap around beside each particle, and what is behind a row is near, too.
  const Vec3f size{0.9f, 3, 3};
  search(40'001, {0.03f, 0, 0}, size, {{0, 0, 0}, {0, 5.7f, 5.7f}}, 96);
  EXPECT_EQ(list->eventsOnHost().truncated, 0);
  expectLists(true);
}

TEST_P(CodeSearchTest, FindsAllWhereRowsHaveManyCandidates) {
  // About 40 in a cell, and in some rows no more than a word of answers has bits.
  const Vec3f size{1, 1, 0.83f};
  search(33'333, {0, 0, 0}, size, {{0, 0, 0}, size}, 256);
  EXPECT_EQ(list->eventsOnHost().truncated, 0);
  expectLists();
}

TEST_P(CodeSearchTest, FindsAllFarFromTheOrigin) {
  const Vec3f size{2, 2, 1.7f};
  // Where fine cells are known, at the end of that, and beyond.
  for (const float at : {-380.0f, 408.5f, 3000.0f}) {
    const Vec3f lo{at, -at, at};
    search(33'333, lo, size, {lo, lo + size}, 96);
    EXPECT_EQ(list->eventsOnHost().truncated, 0);
    expectLists(true);
  }
}

TEST_P(CodeSearchTest, TellsWhatIsJustWithinTheRadius) {
  // Neighbours of a lattice are the radius apart, or a float's last digit more or less; all are at the
  // borders of cells.
  radius = 0.125f;
  std::mt19937 random(3);
  std::vector<Vec3f> points;
  const auto near = [&](int k) {
    const float at = static_cast<float>(k - 9) * radius;
    const int way = static_cast<int>(random() % 3);
    return way == 0 ? at : std::nextafter(at, way == 1 ? -100.0f : 100.0f);
  };
  for (int z = 0; z < 33; ++z)
    for (int y = 0; y < 33; ++y)
      for (int x = 0; x < 33; ++x) points.push_back({near(x), near(y), near(z)});
  search(points, {{-1.2f, -1.2f, -1.2f}, {3, 3, 3}}, 32);
  expectLists(true);
  const std::vector<int> counts = list->countsOnHost(static_cast<std::int64_t>(points.size()));
  const double mean = std::accumulate(counts.begin(), counts.end(), 0.0) / static_cast<double>(counts.size());
  EXPECT_GT(mean, 1);
  EXPECT_LT(mean, 5);
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
