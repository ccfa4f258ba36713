// Neighbour lists against all pairs, on grids of any shape.
#include "framework/neighbors/neighbor_list.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "framework/neighbors/neighbor_rows.h"
#include "tests/framework/neighbors/listed_pairs.h"
#include "tests/support/devices.h"

namespace weir::test {
namespace {

constexpr Aabb kEverywhere{{-1e30f, -1e30f, -1e30f}, {1e30f, 1e30f, 1e30f}};

std::vector<Vec3f> randomPoints(int count, Vec3f lo, Vec3f hi, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0, 1);
  std::vector<Vec3f> points;
  for (int i = 0; i < count; ++i) {
    const Vec3f t{unit(random), unit(random), unit(random)};
    points.push_back({lo.x + t.x * (hi.x - lo.x), lo.y + t.y * (hi.y - lo.y), lo.z + t.z * (hi.z - lo.z)});
  }
  return points;
}

Pairs allPairs(const std::vector<Vec3f>& points, float radius) {
  Pairs pairs;
  for (int i = 0; i < int(points.size()); ++i)
    for (int j = 0; j < int(points.size()); ++j) {
      const Vec3f d = points[j] - points[i];
      if (i != j && dot(d, d) < radius * radius) pairs.emplace(i, j);
    }
  return pairs;
}

class NeighborListTest : public OnDevice {
 protected:
  /// Particles at rest.
  class Resting : public ParticleSet {
   public:
    Resting(Device& device, const std::vector<Vec3f>& points) : ParticleSet(device) {
      ParticleBatch batch;
      batch.assign(device, points, std::vector<Vec3f>(points.size()));
      append(batch);
    }
  };
};
WEIR_ON_EVERY_DEVICE(NeighborListTest);

TEST_P(NeighborListTest, RowsAreTheListsOneBehindTheOther) {
  const float radius = 0.1f;
  for (const int count : {0, 1, 33, 5000}) {
    Resting particles(*device, randomPoints(count, {-0.3f, 0.1f, -0.2f}, {0.5f, 0.6f, 0.3f}, 23));
    NeighborList list(*device);
    list.configure(radius, 64);
    list.fitGrid({{0, 0, 0}, {1, 1, 1}}, count);
    if (count > 0) list.build(particles, kEverywhere);
    const NeighborRows rows = rowsOf(*device, list, count);
    const std::vector<int> offsets = rows.offsets.toHost(), indices = rows.indices.toHost();
    ASSERT_EQ(offsets.size(), static_cast<std::size_t>(count) + 1);
    EXPECT_EQ(offsets.front(), 0);
    EXPECT_EQ(offsets.back(), static_cast<int>(indices.size()));
    if (count == 0) continue;
    const std::vector<std::vector<int>> lists = list.listsOnHost(count);
    for (std::size_t i = 0; i < lists.size(); ++i)
      EXPECT_EQ(std::vector<int>(indices.begin() + offsets[i], indices.begin() + offsets[i + 1]), lists[i]);
  }
}

TEST_P(NeighborListTest, FindsAllPairsOnAnyGrid) {
  const float radius = 0.1f;
  for (const int count : {1, 2, 33, 1000}) {
    const std::vector<Vec3f> points = randomPoints(count, {-0.3f, 0.1f, -0.2f}, {0.5f, 0.6f, 0.3f}, 17);
    const Pairs expected = allPairs(points, radius);
    for (const Aabb& box : {Aabb{}, Aabb{{0, 0, 0}, {0.1f, 0.1f, 0.1f}}, Aabb{{-1, -1, -1}, {1, 1, 1}},
                            Aabb{{-1, 0, 0}, {1, 0, 0}}}) {
      Resting particles(*device, points);
      NeighborList list(*device);
      list.configure(radius, 200);
      list.fitGrid(box, 1 << 20);
      list.build(particles, kEverywhere);
      EXPECT_EQ(listedPairs(particles, list), expected) << count;
      EXPECT_EQ(list.eventsOnHost().truncated, 0);
    }
  }
}

TEST_P(NeighborListTest, FindsAllPairsInCrowdedCells) {
  // Around each cell are more than the thousand candidates that the CPU looks at together.
  const float radius = 0.1f;
  const std::vector<Vec3f> points = randomPoints(3000, {0, 0, 0}, {0.4f, 0.4f, 0.4f}, 11);
  Resting particles(*device, points);
  NeighborList list(*device);
  list.configure(radius, 384);
  list.fitGrid({{0, 0, 0}, {0.4f, 0.4f, 0.4f}}, 3000);
  list.build(particles, kEverywhere);
  EXPECT_EQ(listedPairs(particles, list), allPairs(points, radius));
  EXPECT_EQ(list.eventsOnHost().truncated, 0);
}

TEST_P(NeighborListTest, AllAttributesTravelIntoTheOrderOfTheCells) {
  const FreeMotion motion{{0, -9.8f, 1}, 0.01f};
  const float radius = 0.05f;
  const auto many = int(ParticleSet::kFew) + 1000;
  // Few are sorted in another way than many. Some cells hold hundreds.
  for (const int count : {1000, 20000, many}) {
    std::vector<Vec3f> points = randomPoints(count, {0, 0, 0}, {2, 1, 1}, 5);
    for (int i = 0; i < 500; ++i) points[std::size_t(i)] = {1.025f, 0.525f, 0.525f};
    std::vector<Vec3f> velocities = randomPoints(count, {-1, -1, -1}, {1, 1, 1}, 6);
    points.back() = {-7, 0, 0};  // where it is removed
    ParticleSet particles(*device);
    const Attribute<float> heat = particles.add<float>({.name = "heat", .unit = "", .doc = ""});
    ParticleBatch batch;
    batch.assign(*device, points, velocities);
    particles.append(batch);
    std::vector<float> heats;
    for (int i = 0; i < count; ++i) heats.push_back(float(i) + 0.5f);
    heat.assign(heats);
    NeighborList list(*device);
    list.configure(radius, 24);
    list.fitGrid({{0, 0, 0}, {2, 1, 1}}, count);
    particles.move(motion);
    list.build(particles, {{-3, -3, -3}, {3, 3, 3}});
    const std::int64_t n = particles.refreshCount();
    ASSERT_EQ(n, count - 1);
    const std::vector<int> ids = particles.ids().toHost(n);
    const std::vector<Vec3f> p = particles.positions().toHost(n), v = particles.velocities().toHost(n);
    const std::vector<float> h = heat.toHost(n);
    std::vector<bool> there(points.size());
    for (std::size_t k = 0; k < ids.size(); ++k) {
      const auto i = std::size_t(ids[k]);
      ASSERT_FALSE(there[i]) << i;
      there[i] = true;
      const Vec3f faster = velocities[i] + motion.dt * motion.acceleration;
      // Multiplication and addition may be rounded once or twice.
      ASSERT_LE(length(v[k] - faster), 1e-6f) << i;
      ASSERT_LE(length(p[k] - (points[i] + motion.dt * faster)), 1e-6f) << i;
      ASSERT_EQ(h[k], heats[i]);
    }
    // Those in one cell keep their order.
    const auto crowd = std::find(ids.begin(), ids.end(), 0);
    ASSERT_GE(ids.end() - crowd, 1);
    int last = -1;
    for (const int id : ids) {
      if (id >= 500) continue;
      EXPECT_GT(id, last);
      last = id;
    }
  }
}

TEST_P(NeighborListTest, PlacesHoldPositionAndCrowding) {
  const float radius = 0.1f;
  // Searched for by teams of threads, and by one each.
  for (const int count : {1000, 40000}) {
    const Vec3f size = (count > 1000 ? 4.0f : 1.0f) * Vec3f{1, 0.5f, 0.5f};
    const std::vector<Vec3f> points = randomPoints(count, {}, size, 7);
    Resting particles(*device, points);
    NeighborList list(*device);
    list.configure(radius, 64);
    list.fitGrid({{}, size}, count);
    list.build(particles, kEverywhere);
    ASSERT_GE(particles.byProducts().find(kCrowding).size, count);
    EXPECT_EQ(particles.byProducts().find(kPlaces).size, 0);
    const bool onCuda = device->kind() == DeviceKind::kCuda;
    particles.leasePlaces();
    list.build(particles, kEverywhere);
    ASSERT_EQ(particles.byProducts().find(kPlaces).size >= count, onCuda);
    ASSERT_EQ(particles.byProducts().find(kCrowding).size >= count, !onCuda);
    if (!onCuda) continue;
    std::vector<Vec4f> places(points.size());
    device->download(places.data(), particles.byProducts().find(kPlaces).data, places.size() * sizeof(Vec4f));
    const std::vector<Vec3f> p = particles.positions().toHost(count);
    const std::vector<std::vector<int>> lists = list.listsOnHost(count);
    for (std::size_t i = 0; i < places.size(); ++i) {
      EXPECT_EQ((Vec3f{places[i].x, places[i].y, places[i].z}), p[i]);
      double crowding = 1;
      for (const int j : lists[i]) {
        const Vec3f d = p[std::size_t(j)] - p[i];
        crowding += std::pow(1 - std::sqrt(double(dot(d, d))) / radius, 3);
      }
      ASSERT_NEAR(places[i].w, crowding, 1e-4 * crowding) << i;
    }
    // Whoever asks for the memory may have written there.
    particles.leasePlaces();
    EXPECT_EQ(particles.byProducts().find(kPlaces).size, 0);
  }
}

TEST_P(NeighborListTest, FindsPairsFarFromTheOriginAndFarApart) {
  const float radius = 1.0f;
  std::vector<Vec3f> points = randomPoints(200, {9000, -5000, 100}, {9004, -4996, 104}, 3);
  for (const Vec3f& p : randomPoints(200, {-1e6f, -1e6f, -1e6f}, {1e6f, 1e6f, 1e6f}, 4)) points.push_back(p);
  Resting particles(*device, points);
  NeighborList list(*device);
  list.configure(radius, 200);
  list.fitGrid({{-1e6f, -1e6f, -1e6f}, {1e6f, 1e6f, 1e6f}}, 400);
  list.build(particles, kEverywhere);
  EXPECT_EQ(listedPairs(particles, list), allPairs(points, radius));
}

/// The same as allPairs() of many points, by a sweep along x.
Pairs pairsBySweep(const std::vector<Vec3f>& points, float radius) {
  std::vector<int> order(points.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, {}, [&](int i) { return points[static_cast<std::size_t>(i)].x; });
  Pairs pairs;
  for (std::size_t a = 0; a < order.size(); ++a) {
    const Vec3f p = points[static_cast<std::size_t>(order[a])];
    for (std::size_t b = a + 1; b < order.size(); ++b) {
      const Vec3f d = points[static_cast<std::size_t>(order[b])] - p;
      if (d.x >= radius) break;
      if (dot(d, d) >= radius * radius) continue;
      pairs.emplace(order[a], order[b]);
      pairs.emplace(order[b], order[a]);
    }
  }
  return pairs;
}

TEST_P(NeighborListTest, FindsAllPairsOfManyInWideLayers) {
  // Layers of the grid have more particles than a window of packed lists, and the grid wraps around within
  // them.
  const float radius = 0.1f;
  const Vec3f lo{-10, -10, -0.1f}, hi{10, 10, 0.1f};
  const std::vector<Vec3f> points = randomPoints(90'000, lo, hi, 5);
  Resting particles(*device, points);
  NeighborList list(*device);
  list.configure(radius, 40);
  list.fitGrid({lo, hi}, 90'000);
  list.build(particles, kEverywhere);
  EXPECT_EQ(list.eventsOnHost().truncated, 0);
  EXPECT_TRUE(listedPairs(particles, list) == pairsBySweep(points, radius));
}

TEST_P(NeighborListTest, CountsListsThatAreCutOff) {
  const std::vector<Vec3f> points(20, Vec3f{0.5f, 0.5f, 0.5f});
  Resting particles(*device, points);
  NeighborList list(*device);
  list.configure(0.1f, 8);
  list.build(particles, kEverywhere);
  EXPECT_EQ(list.eventsOnHost().truncated, 20);
  EXPECT_EQ(listedPairs(particles, list).size(), 20u * 8u);
}

/// Points in a few tight clusters, far from each other.
std::vector<Vec3f> clusteredPoints(int count) {
  std::vector<Vec3f> points;
  for (unsigned cluster = 0; cluster < 8; ++cluster) {
    const Vec3f at{0.9f * float(cluster % 2), 0.9f * float(cluster / 2 % 2), 0.9f * float(cluster / 4)};
    const std::vector<Vec3f> some = randomPoints(count / 8, at, at + Vec3f{0.12f, 0.12f, 0.12f}, cluster);
    points.insert(points.end(), some.begin(), some.end());
  }
  return points;
}

std::vector<Vec3f> onePointInEachCell(int side, float cell) {
  std::vector<Vec3f> points;
  for (int z = 0; z < side; ++z)
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x)
        points.push_back(cell * Vec3f{float(x) + 0.5f, float(y) + 0.5f, float(z) + 0.5f});
  return points;
}

TEST_P(NeighborListTest, EverySearchFindsWhatThePortableOneFinds) {
  struct Case {
    std::vector<Vec3f> points;
    float radius;
    int capacity;
    bool overflows;
  };
  // Few and many, which CUDA searches in different ways.
  const Case cases[] = {{randomPoints(2000, {}, {1, 1, 1}, 3), 0.1f, 64, false},
                        {randomPoints(40000, {}, {1, 1, 1}, 4), 0.05f, 64, false},
                        {clusteredPoints(2000), 0.05f, 200, false},
                        {onePointInEachCell(12, 0.1f), 0.101f, 32, false},
                        {onePointInEachCell(34, 0.1f), 0.101f, 32, false},
                        {clusteredPoints(2000), 0.1f, 24, true},
                        {clusteredPoints(40000), 0.02f, 24, true}};
  for (const auto& [points, radius, capacity, overflows] : cases) {
    Resting particles(*device, points), same(*device, points);
    NeighborList fast(*device), portable(*device);
    portable.usePortableSearch();
    const auto count = std::int64_t(points.size());
    for (NeighborList* list : {&fast, &portable}) {
      list->configure(radius, capacity);
      list->fitGrid({{0, 0, 0}, {1, 1, 1}}, count);
    }
    fast.build(particles, kEverywhere);
    portable.build(same, kEverywhere);
    ASSERT_EQ(particles.ids().toHost(count), same.ids().toHost(count));
    EXPECT_EQ(fast.countsOnHost(count), portable.countsOnHost(count)) << count;
    EXPECT_EQ(fast.eventsOnHost().truncated, portable.eventsOnHost().truncated) << count;
    EXPECT_EQ(fast.eventsOnHost().truncated > 0, overflows) << count;
    if (!overflows) {
      EXPECT_EQ(listedPairs(particles, fast), listedPairs(same, portable)) << count;
      continue;
    }
    // Which neighbours a list that is cut off has is for the search to choose.
    const std::vector<Vec3f> p = particles.positions().toHost(count);
    const std::vector<std::vector<int>> lists = fast.listsOnHost(count);
    for (std::size_t i = 0; i < lists.size(); ++i)
      for (const int j : lists[i]) ASSERT_LT(length(p[std::size_t(j)] - p[i]), radius * 1.000001f) << i;
  }
}

TEST_P(NeighborListTest, RemovesWhatIsOutsideOrNoNumberAndCountsIt) {
  const float nan = std::numeric_limits<float>::quiet_NaN(),
              infinity = std::numeric_limits<float>::infinity();
  Resting particles(*device,
                    {{0, 0, 0}, {5, 0, 0}, {nan, 0, 0}, {0.05f, 0, 0}, {0, -infinity, 0}, {0, 0, 0.9f}});
  NeighborList list(*device);
  list.configure(0.1f, 8);
  list.build(particles, {{-1, -1, -1}, {1, 1, 1}});
  EXPECT_EQ(particles.refreshCount(), 3);
  std::vector<int> ids = particles.ids().toHost(3);
  std::sort(ids.begin(), ids.end());
  EXPECT_EQ(ids, (std::vector<int>{0, 3, 5}));
  EXPECT_EQ(list.eventsOnHost().escaped, 1);
  EXPECT_EQ(list.eventsOnHost().nonFinite, 2);
  EXPECT_EQ(listedPairs(particles, list), (Pairs{{0, 3}, {3, 0}}));
}

TEST(CellGrid, ShapeFollowsTheBoxWithinTheLimit) {
  const CellGrid fits = chooseCellGrid({{0, 0, 0}, {1, 0.5f, 0.25f}}, 0.1f, 1 << 20);
  EXPECT_EQ(fits.cells, (Vec3i{13, 8, 6}));
  const CellGrid wide = chooseCellGrid({{0, 0, 0}, {1e6f, 1, 1e6f}}, 0.1f, 1 << 16);
  EXPECT_LE(wide.cellCount(), 1 << 16);
  EXPECT_GE(wide.cellCount(), 1 << 12);
  EXPECT_GE(std::min({wide.cells.x, wide.cells.y, wide.cells.z}), CellGrid::kMinCells);
}

TEST(CellGrid, HasAsManyCellsAsParticlesNeedThatLeaveTheBox) {
  for (const Aabb& box : {Aabb{}, Aabb{{0, 0, 0}, {1, 0.1f, 0.1f}}}) {
    const CellGrid grid = chooseCellGrid(box, 0.1f, 1 << 20, 30000);
    EXPECT_GE(grid.cellCount(), 15000);
    EXPECT_LE(grid.cellCount(), 60000);
  }
}

TEST(CellGrid, CellsRepeatInAllDirections) {
  CellGrid grid;
  grid.inverseCellSize = 2;
  grid.cells = {4, 5, 6};
  EXPECT_EQ(grid.cellOf({0.1f, 0.1f, 0.1f}), (Vec3i{0, 0, 0}));
  EXPECT_EQ(grid.cellOf({-0.1f, -0.1f, -0.1f}), (Vec3i{3, 4, 5}));
  EXPECT_EQ(grid.cellOf({2.1f, 2.6f, 3.1f}), (Vec3i{0, 0, 0}));
  const Vec3i far = grid.cellOf({1e30f, -1e30f, 3e38f});
  EXPECT_TRUE(far.x >= 0 && far.x < 4 && far.y >= 0 && far.y < 5 && far.z >= 0 && far.z < 6);
}

}  // namespace
}  // namespace weir::test
