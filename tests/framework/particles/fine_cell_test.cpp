// The test of candidates by their fine cells loses none that is near, and leaves out those that are far.
#include "framework/particles/fine_cell.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "framework/compute/lanes.h"

namespace weir::test {
namespace {

struct Pair {
  Vec3f p, q;
};

bool areNear(const Pair& pair, float radius) {
  const Vec3f d = pair.q - pair.p;
  // Or else the search would miss what it adds to the crowding.
  return dot(d, d) < radius * radius || 1 - fastSqrt(dot(d, d)) * (1 / radius) > 0;
}

bool mayBeNear(const Pair& pair, float radius) {
  return FineReach(pair.p, 1 / radius).beyond(FineCell::of(pair.q, 1 / radius)) < 0;
}

/// Calls f with pairs at the distances from..to, in widths of a cell, all over the space that is covered.
template <class F>
void forPairs(double from, double to, float radius, const F& f) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(0, 1), around(-1, 1);
  for (const double extent : {1.0, 40.0, 900.0, 4095.0}) {
    for (int n = 0; n < 100'000; ++n) {
      Vec3d p{around(random) * extent, around(random) * extent, around(random) * extent};
      // Borders of 64ths and of cells are where it is decided which way a place is rounded.
      if (n % 3 == 0) p = {std::floor(p.x * 64) / 64, std::floor(p.y * 64) / 64, std::floor(p.z * 64) / 64};
      if (n % 9 == 0) p = {std::floor(p.x), std::floor(p.y), std::floor(p.z)};
      Vec3d d{around(random), around(random), around(random)};
      if (n % 5 == 0) d = {n % 10 == 0 ? d.x : 0.0, n % 15 == 0 ? d.y : 0.0, d.z};
      const double distance = from + (to - from) * unit(random), scale = distance / std::sqrt(dot(d, d));
      const Vec3d q = p + scale * d;
      f(Pair{Vec3f{float(p.x * radius), float(p.y * radius), float(p.z * radius)},
             Vec3f{float(q.x * radius), float(q.y * radius), float(q.z * radius)}});
    }
  }
}

TEST(FineCell, NoneThatIsNearIsLost) {
  for (const float radius : {0.1f, 0.01896f, 1.0f, 1.0f / 3, 7.3f}) {
    int near = 0;
    // Most of them just within the radius, some a float's rounding beyond it.
    for (const double nearest : {0.0, 0.95, 0.999999}) {
      forPairs(nearest, 1.0000001, radius, [&](const Pair& pair) {
        if (!FineReach::covers(pair.p, 1 / radius) || !areNear(pair, radius)) return;
        ++near;
        ASSERT_TRUE(mayBeNear(pair, radius))
            << pair.p.x << ' ' << pair.p.y << ' ' << pair.p.z << " and " << pair.q.x << ' ' << pair.q.y << ' '
            << pair.q.z << ", radius " << radius;
      });
    }
    EXPECT_GT(near, 800'000);
  }
}

TEST(FineCell, OthersAreLeftOut) {
  // By the errors that its comment admits it may take those for near that are within (66.453 + 2.452)/64.
  forPairs(1.077, 1.9, 0.1f, [&](const Pair& pair) { ASSERT_FALSE(mayBeNear(pair, 0.1f)); });
  int kept = 0, all = 0;
  forPairs(1.04, 1.05, 0.1f, [&](const Pair& pair) {
    kept += mayBeNear(pair, 0.1f) ? 1 : 0;
    ++all;
  });
  EXPECT_LT(kept, all / 3);
}

TEST(FineCell, CoversWhatIsNearTheOriginOnly) {
  EXPECT_TRUE(FineReach::covers({4095, -4095, 0}, 1));
  EXPECT_FALSE(FineReach::covers({0, 0, 4096}, 1));
  EXPECT_FALSE(FineReach::covers({-410, 0, 0}, 10));
}

}  // namespace
}  // namespace weir::test
