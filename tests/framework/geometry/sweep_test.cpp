// Where a sweep ends: in closed form for planes and corners.
#include "framework/geometry/sweep.h"
#include "framework/compute/dispatch.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/framework/geometry/sweep_kernel.h"
#include "tests/support/devices.h"
#include "tests/support/meshes.h"

namespace weir::test {
namespace {

using SweepTest = OnDevice;

constexpr float kThickness = 1e-3f;

std::vector<SweepResult> sweepThrough(Device& device, const TriangleMesh& mesh,
                                      const std::vector<Motion>& asked, float thickness = kThickness) {
  const TriangleTree tree(device, mesh);
  const ClearanceGrid clearance(device, tree.view(), 0.1f);
  const Array<Motion> motions(device, asked);
  Array<SweepResult> out(device, motions.size());
  dispatch(device, [&](auto& d) {
    sweepAll(d, tree.view(), clearance.view(), thickness, motions.view(), out.view());
  });
  return out.toHost();
}

void expectNear(const Vec3f& found, const Vec3f& expected, float tolerance) {
  EXPECT_NEAR(found.x, expected.x, tolerance);
  EXPECT_NEAR(found.y, expected.y, tolerance);
  EXPECT_NEAR(found.z, expected.z, tolerance);
}

TEST_P(SweepTest, MotionsThatMeetNothingEndExactlyWhereTheyShould) {
  const std::vector<Motion> motions = {{{0, 0, 3}, {0.123f, 0.7f, 2.1f}},
                                       {{5, 5, 5}, {5, 5, -5}},
                                       {{0.2f, 0.3f, 0.5f}, {-0.4f, 0.1f, 0.011f}},
                                       {{0, 0, 1e6f}, {0, 1e9f, 1}}};
  const std::vector<SweepResult> found = sweepThrough(*device, sheet(4), motions);
  for (std::size_t i = 0; i < motions.size(); ++i) {
    EXPECT_EQ(found[i].position, motions[i].to);
    EXPECT_FALSE(found[i].hit);
    EXPECT_EQ(found[i].normal, Vec3f{});
  }
}

TEST_P(SweepTest, SlidesAlongASheetAThicknessInFrontOfIt) {
  for (const float side : {1.0f, -1.0f})
    for (const float height : {kThickness, 0.1f, 1.0f}) {
      const Motion motion{{0.1f, -0.2f, side * height}, {0.5f, 0.4f, side * (height - 1.5f)}};
      const SweepResult found = sweepThrough(*device, sheet(5), {motion})[0];
      EXPECT_TRUE(found.hit);
      expectNear(found.position, {0.5f, 0.4f, side * kThickness}, 2e-6f);
      expectNear(found.normal, {0, 0, side}, 1e-6f);
    }
}

TEST_P(SweepTest, StopsInACornerOfABoxAThicknessFromItsThreeFaces) {
  const SweepResult found =
      sweepThrough(*device, boxMesh({-1, -1, -1}, {1, 1, 1}), {{{0, 0, 0}, {3, 4, 5}}})[0];
  EXPECT_TRUE(found.hit);
  expectNear(found.position, {1 - kThickness, 1 - kThickness, 1 - kThickness}, 2e-6f);
  EXPECT_LT(found.normal.x, 0);
  EXPECT_LT(found.normal.y, 0);
  EXPECT_LT(found.normal.z, 0);
  EXPECT_NEAR(length(found.normal), 1, 1e-6);
}

TEST_P(SweepTest, SlidesAlongTheCreaseOfAnAcuteWedge) {
  // Two sheets that meet at 40 degrees in the y axis and open towards x.
  const float slope = std::tan(0.3490659f);
  TriangleMesh wedge;
  wedge.vertices = {{0, -1, 0}, {0, 1, 0}, {1, -1, slope}, {1, 1, slope}, {1, -1, -slope}, {1, 1, -slope}};
  wedge.triangles = {{0, 2, 3}, {0, 3, 1}, {0, 1, 5}, {0, 5, 4}};
  const SweepResult found = sweepThrough(*device, wedge, {{{0.5f, -0.5f, 0}, {-0.5f, 0.3f, 0.1f}}})[0];
  EXPECT_TRUE(found.hit);
  EXPECT_NEAR(found.position.y, 0.3f, 1e-5);
  EXPECT_GT(found.position.x, 0);
  EXPECT_LT(found.position.x, 10 * kThickness);
  EXPECT_GT(found.normal.x, 0.9f);
}

TEST_P(SweepTest, EndsThatAreTooNearArePushedToAThickness) {
  const SweepResult found = sweepThrough(*device, sheet(3), {{{0.1f, 0.2f, 0.01f}, {0.2f, 0.2f, 1e-5f}}})[0];
  EXPECT_TRUE(found.hit);
  expectNear(found.position, {0.2f, 0.2f, kThickness}, 1e-2f * kThickness);
  expectNear(found.normal, {0, 0, 1}, 1e-2f);
}

TEST_P(SweepTest, StartsThatAreTooNearKeepTheirSideAndGoToAThickness) {
  for (const float side : {1.0f, -1.0f})
    for (const float height : {1e-5f, 3e-4f}) {
      const Vec3f from{0.1f, 0.2f, side * height};
      for (const Vec3f& to : {from, Vec3f{0.3f, 0.2f, -side}, Vec3f{0.3f, 0.2f, side * 2 * height}}) {
        const SweepResult found = sweepThrough(*device, sheet(3), {{from, to}})[0];
        expectNear(found.position, {to.x, to.y, side * kThickness}, 2e-6f);
      }
      const SweepResult away = sweepThrough(*device, sheet(3), {{from, {0.3f, 0.1f, side * 0.5f}}})[0];
      EXPECT_EQ(away.position, (Vec3f{0.3f, 0.1f, side * 0.5f}));
    }
}

TEST_P(SweepTest, StartsOnTheSurfaceGoToTheSideOfTheHint) {
  for (const float side : {1.0f, -1.0f})
    for (const Vec3f& from : {Vec3f{0.1f, 0.2f, 0}, Vec3f{0, 0, 0}, Vec3f{0.5f, 0.5f, -side * 1e-8f}})
      for (const float down : {1.0f, -1.0f}) {
        const Motion motion{from, from + Vec3f{0.2f, 0, down}, {0.1f, 0.3f, side}};
        const SweepResult found = sweepThrough(*device, sheet(4), {motion})[0];
        EXPECT_GE(side * found.position.z, 0.99f * kThickness);
      }
  // Without a hint, in front.
  EXPECT_GT(sweepThrough(*device, sheet(4), {{{0.1f, 0.2f, 0}, {0.1f, 0.2f, -1}}})[0].position.z, 0);
}

TEST_P(SweepTest, StaysWhereThereIsNoRoomAhead) {
  // A gap between two sheets that narrows from 0.2 to nothing.
  TriangleMesh gap;
  gap.vertices = {{0, -1, -0.1f}, {0, 1, -0.1f}, {2, -1, 0}, {2, 1, 0}, {0, -1, 0.1f}, {0, 1, 0.1f}};
  gap.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 3, 2}, {4, 5, 3}};
  const SweepResult found = sweepThrough(*device, gap, {{{0, 0, 0}, {1.9999f, 0, 0}}})[0];
  const float half = 0.05f * (2 - found.position.x);
  EXPECT_TRUE(found.hit);
  EXPECT_GT(found.position.x, 0.9f);
  EXPECT_GE(half - std::abs(found.position.z), 0.49f * kThickness);
}

TEST_P(SweepTest, ThicknessIsRaisedToWhatFloatsCanTell) {
  TriangleMesh far = sheet(4);
  for (Vec3f& v : far.vertices) v += Vec3f{0, 0, 1000};
  const SweepResult found = sweepThrough(*device, far, {{{0.1f, 0.2f, 1001}, {0.1f, 0.2f, 999}}}, 1e-6f)[0];
  EXPECT_GT(found.position.z, 1000 + 0.9f * minThickness(1000));
  EXPECT_LT(found.position.z, 1000 + 1.1f * minThickness(1001));
}

TEST_P(SweepTest, WhatIsNoNumberPassesAndSoDoesAllWithoutAMesh) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const SweepResult lost = sweepThrough(*device, sheet(2), {{{0, 0, 1}, {0, nan, -1}}})[0];
  EXPECT_FALSE(isFinite(lost.position));
  EXPECT_FALSE(lost.hit);
  const SweepResult free = sweepThrough(*device, TriangleMesh{}, {{{0, 0, 1}, {0, 0, -1}}})[0];
  EXPECT_EQ(free.position, (Vec3f{0, 0, -1}));
}

TEST_P(SweepTest, TrianglesWithoutAreaBlockNothingAndBreakNothing) {
  TriangleMesh mesh = sheet(2);
  const int n = static_cast<int>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), {{0, 0, 0.5f}, {0.2f, 0, 0.5f}, {0.1f, 0, 0.5f}});
  mesh.triangles.push_back({n, n + 1, n + 2});
  const std::vector<SweepResult> found =
      sweepThrough(*device, mesh, {{{0.1f, 0, 0.7f}, {0.1f, 0, 0.3f}}, {{0.1f, 0, 0.7f}, {0.1f, 0, -3}}});
  EXPECT_EQ(found[0].position, (Vec3f{0.1f, 0, 0.3f}));
  EXPECT_NEAR(found[1].position.z, kThickness, 2e-6);
}

WEIR_ON_EVERY_DEVICE(SweepTest);

}  // namespace
}  // namespace weir::test
