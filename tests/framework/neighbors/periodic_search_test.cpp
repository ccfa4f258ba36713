// Neighbours through the faces of a periodic box against the shortest of all ways between two particles.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <tuple>
#include <vector>

#include "framework/neighbors/neighbor_list.h"
#include "tests/support/devices.h"

namespace weir::test {
namespace {

constexpr float kReach = 0.1f;
constexpr int kCapacity = 200;
constexpr Aabb kEverywhere{{-1e30f, -1e30f, -1e30f}, {1e30f, 1e30f, 1e30f}};

std::vector<Vec3f> cloud(const Period& period, int count, unsigned seed) {
  std::mt19937 random(seed);
  // Some of them have left the box.
  std::uniform_real_distribution<float> along(-0.1f, 1.1f), other(0, 0.3f);
  std::vector<Vec3f> positions;
  for (int i = 0; i < count; ++i) {
    Vec3f p;
    for (int axis = 0; axis < 3; ++axis)
      p[axis] = period.along(axis) ? period.lo[axis] + along(random) * period.size[axis] : other(random);
    positions.push_back(p);
  }
  return positions;
}

double shortest(double d, double size) {
  return size > 0 ? d - size * std::round(d / size) : d;
}

Vec3d way(const Vec3f& a, const Vec3f& b, const Period& period) {
  return {shortest(double(b.x) - a.x, period.size.x), shortest(double(b.y) - a.y, period.size.y),
          shortest(double(b.z) - a.z, period.size.z)};
}

/// Ids of the neighbours of each, by id.
std::vector<std::vector<std::int64_t>> listsById(const NeighborList& neighbors, const ParticleSet& particles,
                                                 const std::vector<std::int64_t>& ids) {
  const auto lists = neighbors.listsOnHost(particles.bound());
  std::vector<std::vector<std::int64_t>> byId(lists.size());
  for (std::size_t i = 0; i < lists.size(); ++i) {
    for (const int j : lists[i]) byId[std::size_t(ids[i])].push_back(ids[std::size_t(j)]);
    std::sort(byId[std::size_t(ids[i])].begin(), byId[std::size_t(ids[i])].end());
  }
  return byId;
}

class PeriodicSearch : public testing::TestWithParam<std::tuple<Period, bool>> {};

TEST_P(PeriodicSearch, FindsWhatIsNearByTheShortestWay) {
  const auto& [period, portable] = GetParam();
  const std::vector<Vec3f> start = cloud(period, 300, 7);
  CpuDevice device(2);
  ParticleSet particles(device);
  ParticleBatch batch;
  batch.assign(device, start, Vec3f{});
  particles.append(batch);
  NeighborList neighbors(device);
  neighbors.configure(kReach, kCapacity);
  if (portable) neighbors.usePortableSearch();
  PeriodicImages images(particles, period, kReach);
  neighbors.build(particles, kEverywhere, {}, &images);
  const std::int64_t owned = particles.bound(), all = owned + particles.haloCount();
  ASSERT_EQ(owned, std::int64_t(start.size()));
  EXPECT_GT(particles.haloCount(), 0);

  const std::vector<std::int64_t> ids = particles.ids().toHost(all);
  const std::vector<Vec3f> positions = particles.positions().toHost(all);
  for (std::int64_t i = 0; i < owned; ++i) {
    const Vec3f p = positions[std::size_t(i)];
    EXPECT_EQ(period.wrapped(p), p);
    EXPECT_LT(length(way(p, start[std::size_t(ids[std::size_t(i)])], period)), 1e-6);
  }
  const auto found = listsById(neighbors, particles, ids);
  int missed = 0;
  for (std::size_t i = 0; i < start.size(); ++i) {
    std::vector<std::int64_t> expected;
    for (std::size_t j = 0; j < start.size(); ++j) {
      const double distance = length(way(start[i], start[j], period));
      // Rounding decides about those right at the radius.
      if (std::abs(distance - kReach) < 1e-6) {
        ++missed;
        if (std::binary_search(found[i].begin(), found[i].end(), std::int64_t(j))) expected.push_back(j);
      } else if (j != i && distance < kReach) {
        expected.push_back(std::int64_t(j));
      }
    }
    ASSERT_EQ(found[i], expected) << i;
  }
  EXPECT_LT(missed, 100);
}

TEST_P(PeriodicSearch, ImagesShowWhatTheirOwnersHave) {
  const auto& [period, portable] = GetParam();
  CpuDevice device(2);
  ParticleSet particles(device);
  ParticleBatch batch;
  batch.assign(device, cloud(period, 300, 3), Vec3f{});
  particles.append(batch);
  const Attribute<float> heat = particles.add<float>({.name = "heat", .unit = "", .doc = ""});
  NeighborList neighbors(device);
  neighbors.configure(kReach, kCapacity);
  PeriodicImages images(particles, period, kReach);
  neighbors.build(particles, kEverywhere, {}, &images);
  const std::int64_t owned = particles.bound(), all = owned + particles.haloCount();

  // Owned particles move, warm up and get numbers of their own.
  const auto count = static_cast<std::size_t>(all);
  std::vector<Vec3f> moved = particles.positions().toHost(owned), vectors(count);
  std::vector<float> warm;
  std::vector<Vec4f> places(count);
  for (std::size_t i = 0; i < moved.size(); ++i) {
    moved[i] += Vec3f{0.01f, -0.02f, 0.03f};
    warm.push_back(float(i));
    vectors[i] = {1, float(i), 2};
    places[i] = {moved[i].x, moved[i].y, moved[i].z, 5 * float(i)};
  }
  particles.positions().assign(moved);
  heat.assign(warm);
  Array<Vec3f> scratch(device, vectors);
  Array<Vec4f> states(device, places);
  images.refresh({"position", "heat"});
  images.refresh(scratch.view());
  images.refresh(states.view());

  const std::vector<std::int64_t> ids = particles.ids().toHost(all);
  std::vector<std::size_t> ownerOf(moved.size());
  for (std::size_t i = 0; i < std::size_t(owned); ++i) ownerOf[std::size_t(ids[i])] = i;
  const std::vector<Vec3f> positions = particles.positions().toHost(all), shown = scratch.toHost();
  const std::vector<float> temperatures = heat.toHost(all);
  const std::vector<Vec4f> state = states.toHost();
  for (auto k = std::size_t(owned); k < std::size_t(all); ++k) {
    const std::size_t owner = ownerOf[std::size_t(ids[k])];
    const Vec3f apart = positions[k] - positions[owner];
    for (int axis = 0; axis < 3; ++axis) {
      const double turns = period.along(axis) ? double(apart[axis]) / double(period.size[axis]) : 0.0;
      EXPECT_NEAR(double(apart[axis]), std::round(turns) * double(period.size[axis]), 1e-6);
    }
    EXPECT_GT(length(apart), 0.5f * 2 * kReach);
    EXPECT_EQ(temperatures[k], warm[owner]);
    EXPECT_EQ(shown[k], vectors[owner]);
    EXPECT_EQ((Vec3f{state[k].x, state[k].y, state[k].z}), positions[k]);
    EXPECT_EQ(state[k].w, places[owner].w);
  }
}

INSTANTIATE_TEST_SUITE_P(Boxes, PeriodicSearch,
                         testing::Combine(testing::Values(Period{{-0.3f, 0, 0}, {0.7f, 0, 0}},
                                                          Period{{0, 0, 1}, {0.45f, 0, 0.21f}},
                                                          Period{{-5, 2, 0.1f}, {0.2f, 0.2f, 0.2f}},
                                                          Period{{0, 0, 0}, {0, 1, 0}}),
                                          testing::Bool()));

}  // namespace
}  // namespace weir::test
