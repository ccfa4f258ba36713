#include "nodes/fluid_surface/spray.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>

#include "nodes/fluid_surface/fluid_mesher.h"
#include "tests/nodes/fluid_surface/host_mesh.h"
#include "tests/support/devices.h"
#include "tests/support/fluid_scene.h"

namespace weir {
namespace {

constexpr float kSpacing = 0.02f;

/// The surface and the spray of particles that are one m/s faster than the one before.
class Sprayed {
 public:
  Sprayed(Device& device, std::vector<Vec3f> positions)
      : scene_(device, positions, velocitiesOf(positions), test::object({{"spacing", double(kSpacing)}})),
        mesher_(device, {.leavesSpray = true}, kSpacing),
        mesh_{Array<Vec3f>(device), Array<Vec3f>(device), Array<Vec3i>(device)} {
    scene_.gravity = {};
    scene_.reset(1e-3);
    mesher_.make(scene_.fluid().fluid->set(), mesh_);
  }

  TriangleMesh mesh() const { return test::onHost(mesh_); }
  std::vector<Vec3f> positions() const { return mesher_.spray().positions().toHost(); }
  std::vector<float> radii() const { return mesher_.spray().radii().toHost(); }
  /// Of which particle each drop is.
  std::vector<std::size_t> owners() const {
    std::vector<std::size_t> owners;
    for (const Vec3f& v : mesher_.spray().velocities().toHost())
      owners.push_back(std::size_t(std::lround(v.x)));
    return owners;
  }

 private:
  static std::vector<Vec3f> velocitiesOf(const std::vector<Vec3f>& positions) {
    std::vector<Vec3f> all;
    for (std::size_t i = 0; i < positions.size(); ++i) all.push_back({float(i), 0, 0});
    return all;
  }

  test::FluidScene scene_;
  FluidMesher mesher_;
  DynamicMesh mesh_;
};

std::vector<Vec3f> block(int x, int y, int z) {
  std::vector<Vec3f> all;
  for (int k = 0; k < z; ++k)
    for (int j = 0; j < y; ++j)
      for (int i = 0; i < x; ++i) all.push_back(kSpacing * Vec3f{float(i), float(j), float(k)});
  return all;
}

double volumeOf(const std::vector<float>& radii) {
  double sum = 0;
  for (const float r : radii) sum += 4 * M_PI / 3 * std::pow(double(r), 3);
  return sum;
}

using SprayTest = test::OnDevice;

TEST_P(SprayTest, LoneParticlesAreDropsOfTheirVolumeAroundTheirWayAndAsFast) {
  std::vector<Vec3f> lone;
  for (int i = 0; i < 300; ++i) lone.push_back({0.2f * float(i % 20), 0.2f * float(i / 20), 0.1f});
  const Sprayed sprayed(*device, lone);
  EXPECT_TRUE(sprayed.mesh().triangles.empty());
  const std::vector<Vec3f> drops = sprayed.positions();
  ASSERT_EQ(drops.size(), lone.size() * Spray::kDrops);
  const std::vector<std::size_t> owners = sprayed.owners();
  Vec3d middle, squares;
  for (std::size_t k = 0; k < drops.size(); ++k) {
    const Vec3f away = drops[k] - lone.at(owners[k]);
    const float along = std::min(3 * kSpacing, Spray::kLag * float(owners[k]));
    ASSERT_LE(std::abs(away.x), 3.001f * kSpacing + along);
    ASSERT_LE(std::abs(away.y), 3.001f * kSpacing);
    middle += Vec3d{away.x, away.y, away.z} / double(drops.size());
    squares += Vec3d{away.x * away.x, away.y * away.y, away.z * away.z} / double(drops.size());
  }
  EXPECT_LT(std::sqrt(dot(middle, middle)), 0.05 * double(kSpacing));
  // A deviation of one spacing, and along their way that of even numbers up to three, as nearly all are fast.
  const double square = double(kSpacing) * double(kSpacing);
  EXPECT_NEAR(squares.y / square, 1, 0.05);
  EXPECT_NEAR(squares.z / square, 1, 0.05);
  EXPECT_NEAR(squares.x / square, 1 + 3, 0.2);
  for (std::size_t i = 0; i < lone.size(); ++i)
    EXPECT_EQ(std::count(owners.begin(), owners.end(), i), Spray::kDrops);
  const std::vector<float> radii = sprayed.radii();
  EXPECT_NEAR(volumeOf(radii) / (double(lone.size()) * std::pow(double(kSpacing), 3)), 1, 0.03);
  const auto [least, most] = std::minmax_element(radii.begin(), radii.end());
  EXPECT_NEAR(*most / *least, 3, 0.05);
  const double mean = double(Spray::meanRadius()) * double(kSpacing);
  EXPECT_NEAR((*least + *most) / 2, mean, 0.02 * mean);
}

TEST_P(SprayTest, WhatHangsTogetherHasNone) {
  // A block, and the inside of a layer of single particles.
  EXPECT_TRUE(Sprayed(*device, block(8, 8, 8)).positions().empty());
  const std::vector<Vec3f> layer = block(12, 1, 12);
  const Sprayed sprayed(*device, layer);
  EXPECT_EQ(test::components(sprayed.mesh()), 1);
  for (const std::size_t i : sprayed.owners()) {
    const Vec3f p = (1 / kSpacing) * layer.at(i);
    EXPECT_TRUE(std::min(p.x, p.z) < 1.5f || std::max(p.x, p.z) > 9.5f) << p.x << ' ' << p.z;
  }
}

TEST_P(SprayTest, DropsStayAsTheyAreWhateverElseThereIs) {
  const auto seen = [&](const Sprayed& sprayed, std::size_t i, const Vec3f& at) {
    std::vector<Vec3f> offsets;
    const std::vector<Vec3f> drops = sprayed.positions();
    const std::vector<std::size_t> owners = sprayed.owners();
    for (std::size_t k = 0; k < drops.size(); ++k)
      if (owners[k] == i) offsets.push_back(drops[k] - at);
    return offsets;
  };
  std::vector<Vec3f> places{{-1, 0, 0}, {0.1f, 0.7f, 0.2f}};
  const std::vector<Vec3f> before = seen(Sprayed(*device, places), 1, places[1]);
  places[1] += {0.003f, 0.3f, 0};
  for (const Vec3f& p : block(6, 6, 6)) places.push_back(p + Vec3f{-0.5f, -2, 0});
  const std::vector<Vec3f> after = seen(Sprayed(*device, places), 1, places[1]);
  ASSERT_EQ(before.size(), std::size_t(Spray::kDrops));
  ASSERT_EQ(after.size(), before.size());
  for (std::size_t k = 0; k < before.size(); ++k) EXPECT_LT(length(before[k] - after[k]), 1e-6f);
}

TEST_P(SprayTest, NothingIsOfNothing) {
  const Sprayed sprayed(*device, {});
  EXPECT_TRUE(sprayed.positions().empty());
  EXPECT_TRUE(sprayed.mesh().triangles.empty());
}

WEIR_ON_EVERY_DEVICE(SprayTest);

TEST(DropsInAir, HoldTogetherUpToThoseOfTheLargestRain) {
  EXPECT_FALSE(breaksUp(0.0048f));  // 5.96 mm across
  EXPECT_TRUE(breaksUp(0.0049f));   // 6.08 mm
}

}  // namespace
}  // namespace weir
