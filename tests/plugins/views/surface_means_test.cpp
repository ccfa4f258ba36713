// What a fluid has where its surface is.
#include "plugins/views/surface_means.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace weir::test {
namespace {

using rendering::meansAt;
using rendering::mixedAlong;
using rendering::NearParticles;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

/// A lattice around the origin, on both sides of it.
std::vector<Vec3f> lattice(int half, float spacing) {
  std::vector<Vec3f> places;
  for (int z = -half; z <= half; ++z)
    for (int y = -half; y <= half; ++y)
      for (int x = -half; x <= half; ++x) places.push_back({spacing * x, spacing * y, spacing * z});
  return places;
}

TEST(SurfaceMeans, AreThoseOfTheFluidThatTurns) {
  // A linear field is its own mean over a lattice that is symmetric about the place.
  constexpr float kSpacing = 0.1f;
  const std::vector<Vec3f> positions = lattice(6, kSpacing);
  const Vec3f spin{0.5f, -1, 2}, drift{1, 0, -3};
  std::vector<Vec3f> velocities;
  for (const Vec3f& p : positions) velocities.push_back(drift + cross(spin, p));
  const std::vector<Vec3f> places{{0, 0, 0}, {0.2f, -0.3f, 0.1f}, {-0.35f, 0.05f, 0.25f}};
  const std::vector<Vec3f> found = meansAt(places, NearParticles(positions, 2 * kSpacing), velocities);
  ASSERT_EQ(found.size(), places.size());
  for (std::size_t i = 0; i < places.size(); ++i)
    EXPECT_LT(length(found[i] - (drift + cross(spin, places[i]))), 1e-5f) << i;
}

TEST(SurfaceMeans, CountThoseThatAreNearAlone) {
  const std::vector<Vec3f> positions{{0, 0, 0}, {0.19f, 0, 0}, {0.21f, 0, 0}, {kNaN, 0, 0}};
  const std::vector<Vec3f> velocities{{1, 0, 0}, {3, 0, 0}, {100, 0, 0}, {100, 0, 0}};
  const std::vector<Vec3f> found =
      meansAt(std::vector<Vec3f>{{0, 0, 0}, {5, 5, 5}, {kNaN, 0, 0}, {1e30f, 0, 0}},
              NearParticles(positions, 0.2f), velocities);
  const float far = 1 - 0.19f * 0.19f / (0.2f * 0.2f), weight = far * far;
  EXPECT_NEAR(found[0].x, (1 + 3 * weight) / (1 + weight), 1e-5f);
  for (std::size_t i = 1; i < found.size(); ++i) EXPECT_EQ(length(found[i]), 0) << i;
}

TEST(SurfaceMeans, AreNoneWithoutParticles) {
  const std::vector<Vec3f> one{{1, 2, 3}};
  EXPECT_EQ(length(meansAt(one, NearParticles({}, 0.1f), {}).front()), 0);
  EXPECT_TRUE(meansAt({}, NearParticles(one, 0.1f), one).empty());
}

TEST(SurfaceMeans, MixLikeHeatAlongTheSurface) {
  constexpr int kHalf = 30, kSide = 2 * kHalf + 1;
  std::vector<Vec3f> vertices, vectors(std::size_t(kSide * kSide));
  std::vector<Vec3i> triangles;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      vertices.push_back({0.1f * float(x - kHalf), 0, 0.1f * float(y - kHalf)});
      if (x + 1 == kSide || y + 1 == kSide) continue;
      const int corner = kSide * y + x;
      triangles.push_back({corner, corner + kSide, corner + 1});
      triangles.push_back({corner + 1, corner + kSide, corner + kSide + 1});
    }
  const MeshSpan mesh{vertices, {}, triangles};
  vectors[std::size_t(kSide * kHalf + kHalf)] = {1, 0, 2};
  Vec3f sum;
  float spread = 0;
  const std::vector<Vec3f> mixed = mixedAlong(mesh, vectors, 0.2f);
  for (std::size_t i = 0; i < mixed.size(); ++i) {
    sum += mixed[i];
    spread += mixed[i].x * dot(vertices[i], vertices[i]);
  }
  EXPECT_LT(length(sum - Vec3f{1, 0, 2}), 1e-5f);
  EXPECT_NEAR(std::sqrt(spread / 2), 0.2f, 0.005f);
  EXPECT_EQ(mixedAlong(mesh, vectors, 0), vectors);
  EXPECT_TRUE(mixedAlong({}, {}, 1).empty());
}

}  // namespace
}  // namespace weir::test
