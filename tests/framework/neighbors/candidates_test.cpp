// The test of candidates by coordinates of 16 bits loses none that is near, and leaves out those that are
// farther.
#include "framework/neighbors/candidates.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "framework/compute/device.h"

#ifdef WEIR_HAS_LANES

namespace weir::test {
namespace {

constexpr int kPairs = 64;

/// Pairs of points at distances from..to, in widths of a cell, up to `extent` of these from the origin.
struct Pairs {
  std::vector<Vec3f> p, q;

  Pairs(double from, double to, double extent, float radius, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0, 1), around(-1, 1);
    for (int n = 0; n < kPairs; ++n) {
      Vec3d a{around(random) * extent, around(random) * extent, around(random) * extent};
      // Borders of steps are where it is decided which way a place is rounded.
      if (n % 3 == 0) a = {std::floor(a.x * 8192) / 8192, std::floor(a.y * 8192) / 8192, std::floor(a.z)};
      Vec3d d{around(random), around(random), around(random)};
      if (n % 5 == 0) d = {n % 10 == 0 ? d.x : 0.0, n % 15 == 0 ? d.y : 0.0, d.z};
      const Vec3d b = a + (from + (to - from) * unit(random)) / std::sqrt(dot(d, d)) * d;
      p.push_back({float(a.x * radius), float(a.y * radius), float(a.z * radius)});
      q.push_back({float(b.x * radius), float(b.y * radius), float(b.z * radius)});
    }
  }

  bool areNear(int n, float radius) const {
    const Vec3f d = q[std::size_t(n)] - p[std::size_t(n)];
    return dot(d, d) < radius * radius;
  }
};

/// Which of the pairs may be near each other.
std::vector<bool> mayBeNear(CpuDevice& device, const Pairs& pairs, float radius) {
  std::vector<bool> near;
  Array<float> memoryOfP(device), memoryOfQ(device);
  const detail::ShortPlaces p(memoryOfP, kPairs), q(memoryOfQ, kPairs);
  const auto fill = [&](const std::vector<Vec3f>& points, const detail::ShortPlaces& to) {
    const detail::FillShortPlaces kernel{{points.data(), kPairs}, 1 / radius, to};
    for (std::int64_t i = 0; i < kPairs; ++i) kernel(i);
  };
  fill(pairs.p, p), fill(pairs.q, q);
  for (int n = 0; n < kPairs; ++n) {
    const Vec3f& at = pairs.p[std::size_t(n)];
    const float across = std::max({std::abs(at.x), std::abs(at.y), std::abs(at.z)}) / radius;
    const std::uint64_t bits = detail::mayBeNear(q.x, q.y, q.z, p[n], int(detail::reachOf(across)));
    near.push_back((bits >> n & 1) != 0);
  }
  return near;
}

TEST(Candidates, NoneThatIsNearIsLost) {
  CpuDevice device(1);
  for (const float radius : {0.1f, 0.01896f, 1.0f, 1.0f / 3, 7.3f}) {
    int near = 0;
    unsigned seed = 0;
    for (const double extent : {1.0, 40.0, 900.0, 30'000.0, 131'071.0, 300'000.0, 1e9})
      // Most of them just within the radius, some a float's rounding beyond it.
      for (const double nearest : {0.0, 0.95, 0.999999})
        for (int repeat = 0; repeat < 300; ++repeat) {
          const Pairs pairs(nearest, 1.0000001, extent, radius, ++seed);
          const std::vector<bool> may = mayBeNear(device, pairs, radius);
          for (int n = 0; n < kPairs; ++n) {
            if (!pairs.areNear(n, radius)) continue;
            ++near;
            ASSERT_TRUE(may[std::size_t(n)]) << extent << ", radius " << radius << ", seed " << seed;
          }
        }
    EXPECT_GT(near, 100'000);
  }
}

TEST(Candidates, ThoseThatAreFartherAreLeftOut) {
  CpuDevice device(1);
  const float radius = 0.01896f;
  unsigned seed = 0;
  // Six cells away it counts as two.
  for (const auto& [nearest, farthest] : {std::pair(1.003, 1.1), std::pair(1.1, 4.0), std::pair(4.0, 6.0)})
    for (const double extent : {1.0, 40.0, 900.0})
      for (int repeat = 0; repeat < 100; ++repeat) {
        const Pairs pairs(nearest, farthest, extent, radius, ++seed);
        const std::vector<bool> may = mayBeNear(device, pairs, radius);
        for (int n = 0; n < kPairs; ++n)
          ASSERT_FALSE(may[std::size_t(n)]) << nearest << ", extent " << extent << ", seed " << seed;
      }
}

TEST(Candidates, ListsAllOfAnyNumberButOneself) {
  CpuDevice device(1);
  const std::vector<Vec3f> points(1100, Vec3f{0.25f, 0.25f, 0.25f});
  Array<float> memory(device);
  const auto count = std::int64_t(points.size());
  const detail::ShortPlaces places(memory, count);
  for (std::int64_t i = 0; i < count; ++i) detail::FillShortPlaces{{points.data(), count}, 1, places}(i);
  const auto table = std::make_unique<detail::Candidates>();
  std::vector<int> list(std::size_t(detail::Candidates::kMax + detail::Candidates::kWrittenBehind) * kEight);
  for (const int size : {1, 2, 16, 17, 63, 64, 65, 128, 129, 1000, detail::Candidates::kMax}) {
    table->clear();
    // A gap between two ranges.
    const int first = size / 3, gap = 70;
    table->add(places, {0, first});
    const int shift = table->add(places, {first + gap, size + gap});
    table->close();
    const int self = size + gap - 1;
    const int found = table->near(places[self], int(detail::reachOf(0.25f)), unsigned(self + shift),
                                  list.data(), 0, detail::Candidates::kMax);
    ASSERT_EQ(found, size - 1);
    for (int k = 0; k < found; ++k) ASSERT_EQ(list[std::size_t(k) * kEight], k < first ? k : k + gap) << size;
    EXPECT_GT(table->near(places[self], int(detail::reachOf(0.25f)), detail::Candidates::kNone, list.data(),
                          0, size - 1),
              size - 1);
  }
}

}  // namespace
}  // namespace weir::test

#endif
