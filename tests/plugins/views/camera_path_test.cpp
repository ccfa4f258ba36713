#include "plugins/views/camera_path.h"

#include <gtest/gtest.h>

#include <cmath>

#include "framework/base/error.h"
#include "framework/scene/scene_file.h"

namespace weir::rendering {
namespace {

constexpr float kNear = 1e-5f;

void expectNear(const Vec3f& found, const Vec3f& wanted, float tolerance = kNear) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c], wanted[c], tolerance) << "component " << c;
}

/// A camera with settings from JSON that rests at (4, 1, 0) and looks at the origin.
class CameraPath : public testing::Test {
 protected:
  const CameraPose resting{.eye = {4, 1, 0}, .target = {0, 1, 0}, .up = {0, 2, 0}, .fovDegrees = 40};

  void set(const std::string& json) { settings.assignAll(parseJson(json, "camera"), {}); }
  CameraPose at(double time, const std::optional<Vec3f>& followed = std::nullopt) const {
    return cameraAt(settings, resting, time, followed);
  }

  CameraSettings settings;
};

TEST_F(CameraPath, RestsWithoutAnything) {
  expectNear(at(0).eye, resting.eye);
  expectNear(at(7.5).eye, resting.eye);
  expectNear(at(7.5).target, resting.target);
}

TEST_F(CameraPath, GoesThroughItsKeyframes) {
  set(R"({"keyframes": [{"time": 1, "eye": [1, 0, 0], "target": [0, 0, 0]},
                        {"time": 2, "eye": [4, 2, 0], "target": [0, 1, 0], "fov": 20},
                        {"time": 4, "eye": [2, 5, 1], "target": [0, 0, 3]}]})");
  expectNear(at(0).eye, {1, 0, 0});
  expectNear(at(1).eye, {1, 0, 0});
  expectNear(at(2).eye, {4, 2, 0});
  expectNear(at(2).target, {0, 1, 0});
  EXPECT_NEAR(at(2).fovDegrees, 20, kNear);
  EXPECT_NEAR(at(1).fovDegrees, 40, kNear);
  expectNear(at(4).eye, {2, 5, 1});
  expectNear(at(9).target, {0, 0, 3});
}

// A camera that goes as a parabola does not leave it between two inner keyframes.
TEST_F(CameraPath, FollowsAParabola) {
  const auto place = [](double t) {
    return Vec3f{float(1 + t), float(0.5 * t * t - t), float(3 - 0.25 * t * t)};
  };
  std::string keys;
  for (const double time : {0.0, 1.0, 2.5, 3.0, 5.0}) {
    const Vec3f p = place(time);
    keys += (keys.empty() ? "" : ",") + std::string("{\"time\": ") + std::to_string(time) + ", \"eye\": [" +
            std::to_string(p.x) + "," + std::to_string(p.y) + "," + std::to_string(p.z) +
            "], \"target\": [0, -9, 0]}";
  }
  set("{\"keyframes\": [" + keys + "]}");
  for (double time = 1; time <= 3; time += 0.125) expectNear(at(time).eye, place(time), 1e-4f);
}

TEST_F(CameraPath, StartsAndStopsGentlyAndNeverJumps) {
  set(R"({"keyframes": [{"time": 0, "eye": [1, 0, 0], "target": [0, 0, 0]},
                        {"time": 1, "eye": [2, 3, 0], "target": [0, 1, 0]},
                        {"time": 3, "eye": [5, 1, 2], "target": [0, 2, 0]}]})");
  constexpr double kStep = 1e-3;
  const auto speed = [&](double time) {
    return (at(time + kStep).eye - at(time).eye) / static_cast<float>(kStep);
  };
  EXPECT_LT(length(speed(0)), 0.05f);
  EXPECT_LT(length(speed(3 - kStep)), 0.05f);
  EXPECT_GT(length(speed(0.5)), 1);
  EXPECT_LT(length(speed(1) - speed(1 - kStep)), 0.05f) << "no kink at a keyframe";
}

TEST_F(CameraPath, MayGoOnStraightLines) {
  set(R"({"smooth": false, "keyframes": [{"time": 0, "eye": [1, 0, 0], "target": [0, 0, 0]},
                                         {"time": 2, "eye": [5, 4, 0], "target": [0, 1, 0]}]})");
  expectNear(at(0.5).eye, {2, 1, 0});
  expectNear(at(1.5).eye, {4, 3, 0});
  expectNear(at(1.5).target, {0, 0.75f, 0});
}

TEST_F(CameraPath, OrbitsItsTargetAboutTheDirectionUp) {
  set(R"({"orbit_period": 8})");
  expectNear(at(0).eye, {4, 1, 0});
  expectNear(at(2).eye, {0, 1, -4});
  expectNear(at(4).eye, {-4, 1, 0});
  const float diagonal = 4 * std::sqrt(0.5f);
  expectNear(at(801).eye, {diagonal, 1, -diagonal}, 1e-4f);
  set(R"({"orbit_period": -8})");
  expectNear(at(2).eye, {0, 1, 4});
  EXPECT_THROW(set(R"({"orbit_period": 0})"), Error);
}

TEST_F(CameraPath, FollowsAndKeepsItsDistance) {
  const CameraPose camera = at(3, Vec3f{10, 2, 3});
  expectNear(camera.target, {10, 2, 3});
  expectNear(camera.eye, {14, 2, 3});
  set(R"({"orbit_period": 8})");
  expectNear(at(2, Vec3f{10, 2, 3}).eye, {10, 2, -1});
}

}  // namespace
}  // namespace weir::rendering
