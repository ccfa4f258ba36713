// Water on both sides of walls that are thinner than the support: a sheet, and a closed plate.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/nodes/particle_fluid/modules/module_test_support.h"
#include "tests/nodes/semi_analytical_sfi/solid_scene.h"
#include "tests/support/meshes.h"

namespace weir::test {
namespace {

constexpr float kSpacing = 0.02f, kLength = 0.16f, kWidth = 0.08f, kHigh = 0.3f, kLow = 0.15f, kTop = 0.6f;

struct Partition {
  const char* name;
  TriangleMesh mesh;
  float half;  // of its thickness, m
};

/// Between z = 0 and the width, from the ground up; it ends in the tank's walls, as a partition that is
/// fitted does.
std::vector<Partition> partitions() {
  TriangleMesh sheet;
  sheet.vertices = {{0, 0, 0}, {0, kTop, 0}, {0, kTop, kWidth}, {0, 0, kWidth}};
  sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
  return {{"sheet", sheet, 0},
          {"plate", boxMesh({-0.0025f, 0, 0}, {0.0025f, kTop, kWidth}), 0.0025f},
          {"thickWall", boxMesh({-0.05f, 0, 0}, {0.05f, kTop, kWidth}), 0.05f}};
}

struct Column {
  double level = 0;  // m
  double gap = 0;    // mean distance of the nearest layer from the partition, m
};

/// Of the particles on the side where `sign`·x is positive.
Column columnOf(const std::vector<Vec3f>& positions, double sign, double half) {
  double height = 0, gap = 0;
  int count = 0, near = 0;
  for (const Vec3f& p : positions) {
    if (sign * p.x < 0) continue;
    height += p.y;
    ++count;
    const double distance = sign * p.x - half;
    if (distance > 0.8 * kSpacing) continue;
    gap += distance;
    ++near;
  }
  return {2 * height / count, gap / near};
}

class ThinWalls : public testing::TestWithParam<int> {};

TEST_P(ThinWalls, HoldWaterAtDifferentLevels) {
  const Partition wall = partitions()[std::size_t(GetParam())];
  CpuDevice device;
  std::vector<Vec3f> positions =
      block(kSpacing, {-kLength - wall.half, 0, 0}, {-wall.half - 0.001f, kHigh, kWidth});
  const std::size_t left = positions.size();
  for (const Vec3f& p : block(kSpacing, {wall.half, 0, 0}, {wall.half + kLength - 0.001f, kLow, kWidth}))
    positions.push_back(p);
  const std::vector<Vec3f> offsets = randomVelocities(positions.size(), 0.2f * kSpacing, 5);
  for (std::size_t i = 0; i < positions.size(); ++i) positions[i] += offsets[i];
  SolidScene scene = settling(device, kSpacing, positions);
  const float end = kLength + wall.half;
  SemiAnalyticalSFI& tank =
      scene.couple({boxMesh({-end, 0, 0}, {end, kTop, kWidth})}, object({{"fill", "container"}}));
  SemiAnalyticalSFI& partition = scene.couple({wall.mesh});
  scene.reset(kSettlingDt);
  ASSERT_EQ(scene.fluid().particleCount(), std::int64_t(positions.size()));
  scene.step(470);
  scene.frame();
  scene.step(130);
  scene.frame();

  const std::vector<Vec3f> now = scene.positions();
  ASSERT_EQ(now.size(), positions.size());
  for (std::size_t i = 0; i < now.size(); ++i) ASSERT_EQ(now[i].x < 0, i < left);
  const double volume = std::pow(kSpacing, 3), area = kLength * kWidth;
  const double high = double(left) * volume / area, low = double(now.size() - left) * volume / area;
  const Column leftColumn = columnOf(now, -1, wall.half), rightColumn = columnOf(now, 1, wall.half);
  const double onWall = kWater * kGravity * (high * high - low * low) / 2 * kWidth;
  const Vec3d force = partition.forces->solids[0].force, onTank = tank.forces->solids[0].force;
  std::printf("%s: levels %.4f %.4f of %.4f %.4f, force %.3f of %.3f, gaps %.3f %.3f d, sum y %.3f x %.3f\n",
              wall.name, leftColumn.level, rightColumn.level, high, low, force.x, onWall,
              leftColumn.gap / kSpacing, rightColumn.gap / kSpacing,
              (onTank.y + force.y) / (-kWater * kGravity * volume * double(now.size())), onTank.x + force.x);
  // In columns so narrow the disorder at the walls takes room, thick or thin.
  EXPECT_NEAR(leftColumn.level, high, 0.55 * kSpacing);
  EXPECT_NEAR(rightColumn.level, low, 0.55 * kSpacing);
  EXPECT_NEAR(force.x, onWall, 0.05 * onWall);
  const double weight = kWater * kGravity * volume * double(now.size());
  EXPECT_NEAR(onTank.y + force.y, -weight, 0.01 * weight);
  EXPECT_NEAR(onTank.x + force.x, 0, 0.01 * weight);
  // Of a thick wall's nearest layer, the third case, it is 0.39 to 0.41 spacings.
  EXPECT_NEAR(leftColumn.gap, 0.40 * kSpacing, 0.025 * kSpacing);
  EXPECT_NEAR(rightColumn.gap, 0.40 * kSpacing, 0.025 * kSpacing);
}

INSTANTIATE_TEST_SUITE_P(All, ThinWalls, testing::Range(0, 3),
                         [](const auto& tested) { return partitions()[std::size_t(tested.param)].name; });

}  // namespace
}  // namespace weir::test
