#include "plugins/rendering/gl/camera.h"

#include <Eigen/Geometry>
#include <cmath>

#include "framework/base/error.h"
#include "plugins/views/camera_axes.h"

namespace weir::rendering::gl {
namespace {

Eigen::Matrix4f lookAlong(const Axes& axes, const Vec3f& origin) {
  Eigen::Matrix4f view = Eigen::Matrix4f::Identity();
  int row = 0;
  for (const Vec3f& axis : {axes.right, axes.up, axes.back}) {
    view.row(row) << axis.x, axis.y, axis.z, -dot(axis, origin);
    ++row;
  }
  return view;
}

/// The nearest and farthest a box is from a point.
std::pair<float, float> distances(const Aabb& box, const Vec3f& point) {
  const Vec3f nearest = max(box.lo, min(box.hi, point));
  float farthest = 0;
  for (const Vec3f& corner : cornersOf(box)) farthest = std::max(farthest, length(corner - point));
  return {length(nearest - point), farthest};
}

}  // namespace

Eigen::Matrix4f Camera::projection() const {
  const Vec4f terms = projectionTerms();
  Eigen::Matrix4f matrix = Eigen::Matrix4f::Zero();
  matrix(0, 0) = terms.x;
  matrix(1, 1) = terms.y;
  matrix(2, 2) = terms.z;
  matrix(2, 3) = terms.w;
  matrix(3, 2) = -1;
  return matrix;
}

Vec4f Camera::projectionTerms() const {
  return {1 / tangent.x, 1 / tangent.y, (far + near) / (near - far), 2 * far * near / (near - far)};
}

Vec3f Camera::point(const Vec3f& world) const {
  const Eigen::Vector4f p = view * Eigen::Vector4f(world.x, world.y, world.z, 1);
  return {p.x(), p.y(), p.z()};
}

Camera makeCamera(const CameraPose& pose, float aspectRatio, const Aabb& content) {
  const Vec3f back = pose.eye - pose.target;
  if (!isFinite(pose.eye) || !isFinite(pose.target) || !(length(back) > 0))
    throw sceneError("the camera's eye and its target are one point, or are not finite",
                     "two different points");
  Camera camera;
  camera.view = lookAlong(axesOf(back, pose.up), pose.eye);
  const float vertical = tangentOfHalf(pose.fovDegrees);
  camera.tangent = {vertical * aspectRatio, vertical};
  const auto [nearest, farthest] =
      content.empty() ? std::pair{0.0f, length(back)} : distances(content, pose.eye);
  camera.far = 1.01f * farthest + 1e-6f;
  // Depth is stored as 32-bit numbers that are densest near 0, so a ratio of 1 to 5000 leaves enough of them.
  camera.near = std::max(0.5f * nearest / std::max(1.0f, std::hypot(camera.tangent.x, camera.tangent.y)),
                         camera.far * 2e-4f);
  return camera;
}

Eigen::Matrix4f SunView::toClip() const {
  const float depth = zNearest - zFarthest;
  Eigen::Matrix4f clip = Eigen::Matrix4f::Identity();
  clip(0, 0) = clip(1, 1) = 1 / halfSize;
  clip(2, 2) = -2 / depth;
  clip(2, 3) = (zNearest + zFarthest) / depth;
  return clip * view;
}

Eigen::Matrix4f SunView::toTexture() const {
  Eigen::Matrix4f half = Eigen::Matrix4f::Identity() * 0.5f;
  half.col(3) << 0.5f, 0.5f, 0.5f, 1;
  return half * toClip();
}

SunView makeSunView(const Vec3f& towardsSun, const Aabb& casters, int resolution) {
  const Axes axes = axesOf(towardsSun, {0, 1, 0});
  Aabb seen;
  for (const Vec3f& corner : cornersOf(casters))
    seen.extend(Vec3f{dot(corner, axes.right), dot(corner, axes.up), dot(corner, axes.back)});
  SunView sun;
  // Room for soft edges, and steps of a quarter of an octave.
  constexpr float kMargin = 1.08f;
  const float wanted = kMargin * 0.5f * std::max({seen.size().x, seen.size().y, 1e-6f});
  sun.halfSize = std::exp2(std::ceil(4 * std::log2(wanted)) / 4);
  const float texel = 2 * sun.halfSize / float(resolution);
  const Vec3f middle{std::round(seen.center().x / texel) * texel, std::round(seen.center().y / texel) * texel,
                     0};
  sun.view = lookAlong(axes, axes.right * middle.x + axes.up * middle.y);
  const float slack = 0.01f * std::max(seen.size().z, 1e-6f);
  sun.zNearest = seen.hi.z + slack;
  sun.zFarthest = seen.lo.z - slack;
  return sun;
}

}  // namespace weir::rendering::gl
