#include "plugins/views/camera_axes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "framework/base/error.h"
#include "plugins/views/view.h"

namespace weir::rendering {

std::array<Vec3f, 8> cornersOf(const Aabb& box) {
  std::array<Vec3f, 8> corners;
  for (int i = 0; i < 8; ++i)
    corners[i] = {i & 1 ? box.hi.x : box.lo.x, i & 2 ? box.hi.y : box.lo.y, i & 4 ? box.hi.z : box.lo.z};
  return corners;
}

Axes axesOf(const Vec3f& back, const Vec3f& up) {
  const Vec3f z = normalized(back);
  Vec3f x = cross(normalized(up), z);
  constexpr float kParallel = 1e-4f;
  if (!(length(x) > kParallel)) x = cross(std::abs(z.x) < 0.9f ? Vec3f{1, 0, 0} : Vec3f{0, 0, 1}, z);
  x = normalized(x);
  return {x, cross(z, x), z};
}

float tangentOfHalf(float fovDegrees) {
  if (!(fovDegrees > 0 && fovDegrees < 180))
    throw sceneError("the camera's field of view is " + std::to_string(fovDegrees) + " degrees",
                     "more than 0 and less than 180");
  return std::tan(fovDegrees * std::numbers::pi_v<float> / 360.0f);
}

CameraPose poseSeeing(const Aabb& box, const Vec3f& direction, const Vec3f& up, float fovDegrees,
                      float aspectRatio) {
  const Aabb shown = box.empty() ? Aabb{{-0.5f, -0.5f, -0.5f}, {0.5f, 0.5f, 0.5f}} : box;
  const Axes axes = axesOf(direction, up);
  const float vertical = tangentOfHalf(fovDegrees), horizontal = vertical * aspectRatio;
  // A corner q (from the middle) is seen from the distance d if |q·right| ≤ horizontal·(d - q·back), and so
  // on.
  constexpr float kMargin = 1.06f;
  float distance = 1e-3f * (1 + length(shown.size()));
  for (const Vec3f& corner : cornersOf(shown)) {
    const Vec3f q = corner - shown.center();
    const float behind = dot(q, axes.back);
    distance = std::max(distance, behind + kMargin * std::abs(dot(q, axes.right)) / horizontal);
    distance = std::max(distance, behind + kMargin * std::abs(dot(q, axes.up)) / vertical);
  }
  return {shown.center() + axes.back * distance, shown.center(), up, fovDegrees};
}

}  // namespace weir::rendering
