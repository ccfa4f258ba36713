#include "plugins/rendering/gl/camera.h"

#include <gtest/gtest.h>

#include <random>

#include "framework/base/error.h"

namespace weir::rendering {
namespace {

/// The largest |x| or |y| of a box's corners in the picture (1 is the edge), and whether all are between near
/// and far.
std::pair<float, bool> extentInPicture(const gl::Camera& camera, const Aabb& box) {
  float largest = 0;
  bool between = true;
  for (int i = 0; i < 8; ++i) {
    const Vec3f q =
        camera.point({i & 1 ? box.hi.x : box.lo.x, i & 2 ? box.hi.y : box.lo.y, i & 4 ? box.hi.z : box.lo.z});
    between = between && -q.z > camera.near && -q.z < camera.far;
    largest =
        std::max({largest, std::abs(q.x / q.z / camera.tangent.x), std::abs(q.y / q.z / camera.tangent.y)});
  }
  return {largest, between};
}

TEST(CameraPose, SeesTheWholeBoxFromEverywhere) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> any(-1, 1);
  for (int i = 0; i < 300; ++i) {
    const Vec3f a{any(random), any(random), any(random)}, b{any(random), any(random), any(random)};
    const Aabb box{min(a, b) * 10.0f, max(a, b) * 10.0f};
    const Vec3f direction{any(random), any(random), any(random)};
    const float aspect = 1.2f + any(random), fov = 60 + 50 * any(random);
    const CameraPose pose = poseSeeing(box, direction, {0, 1, 0}, fov, aspect);
    const auto [extent, between] = extentInPicture(gl::makeCamera(pose, aspect, box), box);
    EXPECT_LE(extent, 1.0f) << i;
    EXPECT_GE(extent, 0.85f) << i;  // and not from farther away than needed
    EXPECT_TRUE(between) << i;
  }
}

TEST(CameraPose, LooksStraightDownToo) {
  const Aabb box{{-1, -1, -1}, {1, 1, 1}};
  const CameraPose pose = poseSeeing(box, {0, 1, 0}, {0, 1, 0}, 40, 1);
  EXPECT_LE(extentInPicture(gl::makeCamera(pose, 1, box), box).first, 1.0f);
  EXPECT_LE(extentInPicture(gl::makeCamera(poseSeeing({}, {0, 0, 1}, {0, 1, 0}, 40, 1), 1, {}),
                            {{-0.5f, -0.5f, -0.5f}, {0.5f, 0.5f, 0.5f}})
                .first,
            1.0f);
}

TEST(SunView, HoldsAllCastersInItsTexture) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> any(-1, 1);
  for (int i = 0; i < 100; ++i) {
    const Vec3f a{any(random), any(random), any(random)}, b{any(random), any(random), any(random)};
    const Aabb box{min(a, b), max(a, b)};
    const gl::SunView sun = gl::makeSunView({any(random), any(random), any(random)}, box, 1024);
    const Eigen::Matrix4f toTexture = sun.toTexture();
    for (int k = 0; k < 8; ++k) {
      const Eigen::Vector4f corner(k & 1 ? box.hi.x : box.lo.x, k & 2 ? box.hi.y : box.lo.y,
                                   k & 4 ? box.hi.z : box.lo.z, 1);
      const Eigen::Vector4f place = toTexture * corner;
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_GE(place[axis], 0.0f) << i;
        EXPECT_LE(place[axis], 1.0f) << i;
      }
    }
  }
}

TEST(SunView, SmallChangesOfTheSceneMoveNoTexels) {
  const Vec3f sun{0.4f, 1, 0.3f};
  const gl::SunView before = gl::makeSunView(sun, {{-1, 0, -1}, {1, 1, 1}}, 1024);
  const gl::SunView after = gl::makeSunView(sun, {{-1, 0, -1}, {1.01f, 1.003f, 1}}, 1024);
  ASSERT_EQ(before.halfSize, after.halfSize);
  const float texel = 2 * before.halfSize / 1024;
  for (int axis = 0; axis < 2; ++axis) {
    const float moved = (after.view(axis, 3) - before.view(axis, 3)) / texel;
    EXPECT_NEAR(moved, std::round(moved), 1e-3f);
  }
}

}  // namespace
}  // namespace weir::rendering
