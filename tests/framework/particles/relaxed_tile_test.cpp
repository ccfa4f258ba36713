// Relaxed tiles: one particle a node, no order, rest density, everywhere at rest.
#include "framework/particles/relaxed_tile.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "framework/compute/cpu_threads.h"
#include "framework/compute/device.h"
#include "framework/particles/arrangement.h"

namespace weir::test {
namespace {

constexpr int kSide = 8;

std::vector<Vec3d> particlesOf(const RelaxedTile& tile) {
  std::vector<Vec3d> all;
  for (int z = 0; z < kSide; ++z)
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) {
        const Vec3f d = tile.displacement(x, y, z);
        all.push_back({x + double(d.x), y + double(d.y), z + double(d.z)});
      }
  return all;
}

/// Σ_j (1 − r/H)³ and the force −∇ of that of each particle, over all images, by comparing all.
struct Sums {
  double density = 1;
  Vec3d force;
};
Sums sumsAt(const std::vector<Vec3d>& particles, std::size_t i, double supportRatio) {
  Sums sums;
  for (std::size_t j = 0; j < particles.size(); ++j) {
    if (i == j) continue;
    Vec3d d = particles[j] - particles[i];
    for (int axis = 0; axis < 3; ++axis) d[axis] -= kSide * std::round(d[axis] / kSide);
    const double r = length(d), rest = 1 - r / supportRatio;
    if (rest <= 0) continue;
    sums.density += rest * rest * rest;
    sums.force -= 3 * rest * rest / (supportRatio * r) * d;
  }
  return sums;
}

TEST(RelaxedTile, HoldsRestDensityInBalanceAndWithoutOrder) {
  for (const double ratio : {1.2, 1.5, 2.0, 2.4}) {
    CpuThreads threads(2);
    const RelaxedTile tile(ratio, kSide, 200, 1, threads), start(ratio, kSide, 0, 1, threads);
    const std::vector<Vec3d> particles = particlesOf(tile), before = particlesOf(start);
    const double s = calibrationOf(tile, ratio);
    const double perSum = 15 * s / (std::numbers::pi * ratio * ratio * ratio);
    double mean = 0, force = 0, forceBefore = 0, moved = 0;
    for (std::size_t i = 0; i < particles.size(); ++i) {
      const Sums sums = sumsAt(particles, i, ratio);
      mean += perSum * sums.density / double(particles.size());
      force += length(sums.force);
      forceBefore += length(sumsAt(before, i, ratio).force);
      const std::int64_t k = static_cast<std::int64_t>(i);
      moved += length(tile.displacement(k % kSide, k / kSide % kSide, k / kSide / kSide));
    }
    EXPECT_NEAR(mean, 1, 1e-5) << ratio;
    EXPECT_LT(force, 0.05 * forceBefore) << ratio;
    EXPECT_GT(moved / double(particles.size()), 0.15) << ratio;
  }
}

TEST(RelaxedTile, GoesOnForEverAndDependsOnTheSeedAlone) {
  CpuThreads one(1), three(3);
  const RelaxedTile a(1.5, kSide, 50, 7, one), b(1.5, kSide, 50, 7, three), c(1.5, kSide, 50, 8, one);
  EXPECT_EQ(a.displacement(1, 2, 3), b.displacement(1, 2, 3));
  EXPECT_EQ(a.displacement(1, 2, 3), a.displacement(1 - kSide, 2 + 5 * kSide, 3 - 2 * kSide));
  EXPECT_FALSE(a.displacement(1, 2, 3) == c.displacement(1, 2, 3));
}

TEST(TileOfSource, IsMadeOnceForAllThatAskForTheSame) {
  CpuDevice device(1);
  const ParticleBatch::Request request{.spacing = 0.1f, .supportRatio = 1.5f, .disordered = true};
  const auto tile = tileOfSource(request, 3, device), higher = tileOfSource(request, 3, device, 16);
  EXPECT_EQ(tile, tileOfSource(request, 3, device));
  EXPECT_NE(tile, tileOfSource(request, 4, device));
  EXPECT_NE(tile, higher);
  EXPECT_EQ(higher->height(), 16);
}

}  // namespace
}  // namespace weir::test
