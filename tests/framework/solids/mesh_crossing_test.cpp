#include "framework/solids/mesh_crossing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/meshes.h"

namespace weir::test {
namespace {

Pose at(const Vec3f& place, float angle = 0) {
  return {{std::cos(angle / 2), 0, std::sin(angle / 2), 0}, place};
}

TEST(CrossingMesh, TellsWhetherBoxesCross) {
  const CrossingMesh one(boxMesh({0, 0, 0}, {1, 1, 1})), other(boxMesh({0, 0, 0}, {1, 1, 1}));
  EXPECT_FALSE(one.crosses(at({}), other, at({1.01f, 0.3f, 0.2f})));
  EXPECT_TRUE(one.crosses(at({}), other, at({0.99f, 0.3f, 0.2f})));
  EXPECT_TRUE(one.crosses(at({5, 6, 7}), other, at({5.5f, 6.5f, 7.5f})));
  // Turned by 45 degrees about y, its corner reaches out to x = 0.707.
  const float eighth = std::numbers::pi_v<float> / 4;
  EXPECT_FALSE(one.crosses(at({1.42f, 0, 0}, eighth), other, at({0, 0.1f, -0.9f})));
  EXPECT_TRUE(one.crosses(at({0.9f, 0, 0.5f}, eighth), other, at({0, 0.1f, 0})));
}

/// A long bar through a plate: no edge of the plate meets the bar.
TEST(CrossingMesh, FindsWhatPassesThroughAFace) {
  const CrossingMesh plate(boxMesh({-1, -0.01f, -1}, {1, 0.01f, 1})),
      bar(boxMesh({-0.01f, -1, -0.01f}, {0.01f, 1, 0.01f}));
  EXPECT_TRUE(plate.crosses({}, bar, {}));
  EXPECT_TRUE(bar.crosses({}, plate, {}));
}

TEST(CrossingMesh, WhatIsWholeInsideDoesNotCross) {
  const CrossingMesh tank(boxMesh({0, 0, 0}, {2, 2, 2})), box(boxMesh({0, 0, 0}, {1, 1, 1}));
  EXPECT_FALSE(tank.crosses({}, box, at({0.5f, 0.5f, 0.5f})));
  EXPECT_TRUE(tank.crosses({}, box, at({1.1f, 0.5f, 0.5f})));
  EXPECT_FALSE(tank.crosses({}, CrossingMesh(TriangleMesh{}), {}));
}

}  // namespace
}  // namespace weir::test
