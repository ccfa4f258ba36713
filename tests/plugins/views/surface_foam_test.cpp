// How much of a fluid's surface foam covers.
#include "plugins/views/surface_foam.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <random>

#include "nodes/white_water/white_particles.h"

namespace weir::test {
namespace {

using rendering::SurfaceFoam;

constexpr float kReach = 0.1f;
constexpr int kFoam = static_cast<int>(WhiteKind::kFoam);

/// Vertices of a plane, evenly.
std::vector<Vec3f> plane(int half, float step) {
  std::vector<Vec3f> places;
  for (int z = -half; z <= half; ++z)
    for (int x = -half; x <= half; ++x) places.push_back({step * float(x), 0, step * float(z)});
  return places;
}

float sumOf(const std::vector<float>& cover) {
  return std::accumulate(cover.begin(), cover.end(), 0.0f);
}

TEST(SurfaceFoam, CoversTheAreaOfItsParticles) {
  constexpr float kStep = 0.01f, kPi = std::numbers::pi_v<float>;
  const std::vector<Vec3f> vertices = plane(40, kStep);
  SurfaceFoam foam(vertices, kReach);
  const std::vector<Vec3f> places{{0.003f, 0, 0.12f}, {-0.2013f, 0, 0.1027f}};
  const std::vector<float> radii{0.01f, 0.02f};
  foam.lay(places, radii, std::vector<int>{kFoam, kFoam});
  EXPECT_NEAR(sumOf(foam.cover) * kStep * kStep, kPi * (0.01f * 0.01f + 0.02f * 0.02f), 1e-5f);
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const float away = std::min(length(vertices[i] - places[0]), length(vertices[i] - places[1]));
    ASSERT_EQ(foam.cover[i] > 0, away < kReach) << i;
  }
}

TEST(SurfaceFoam, CoversAsMuchInTheMeanAsThereIsOfIt) {
  // 4,000 on a square metre, of 3.14 square centimetres each.
  std::mt19937 random(2);
  std::uniform_real_distribution<float> even(-0.5f, 0.5f);
  std::vector<Vec3f> places(4000);
  for (Vec3f& p : places) p = {even(random), 0, even(random)};
  const std::vector<Vec3f> vertices = plane(20, 0.01f);
  SurfaceFoam foam(vertices, kReach);
  foam.lay(places, std::vector<float>(places.size(), 0.01f), std::vector<int>(places.size(), kFoam));
  EXPECT_NEAR(sumOf(foam.cover) / float(vertices.size()), 1.257f, 0.06f);
}

TEST(SurfaceFoam, LeavesWhatIsNoneOrLiesNowhere) {
  const std::vector<Vec3f> vertices = plane(2, 0.05f);
  SurfaceFoam foam(vertices, kReach);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<Vec3f> places{{0, 0, 0}, {0, 0.05f, 0}, {0, 0.2f, 0}, {0, 0, 0.01f}, {nan, 0, 0}};
  const std::vector<float> radii{0.01f, 0.02f, 0.03f, 0.04f, 0.05f};
  const std::vector<int> kinds{kFoam, kFoam, kFoam, static_cast<int>(WhiteKind::kSpray), kFoam};
  EXPECT_EQ(foam.lay(places, radii, kinds), (std::vector<float>{0, 0, 0.03f, 0.04f, 0.05f}));
  const float before = foam.cover[12];
  EXPECT_NEAR(before, 3 * (0.01f + 0.04f * 0.75f * 0.75f), 1e-5f);
  foam.lay(places, radii, kinds);  // of another node
  EXPECT_FLOAT_EQ(foam.cover[12], 2 * before);
}

}  // namespace
}  // namespace weir::test
