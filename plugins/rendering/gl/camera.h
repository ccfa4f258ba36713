// Matrices of a camera and of the sun's shadow map.
#pragma once

#include <Eigen/Core>
#include <Eigen/LU>

#include "plugins/views/view.h"

namespace weir::rendering::gl {

inline Eigen::Vector3f toEigen(const Vec3f& v) {
  return {v.x, v.y, v.z};
}
inline Vec3f fromEigen(const Eigen::Vector3f& v) {
  return {v.x(), v.y(), v.z()};
}

/// The camera looks along -z of its own space, with x to the right and y up.
struct Camera {
  Eigen::Matrix4f view;     ///< from world to camera space
  Vec2f tangent;            ///< tangents of half the field of view, horizontal and vertical
  float near = 0, far = 0;  ///< m

  Eigen::Matrix4f projection() const;
  /// The four numbers of the projection that are not 0 or -1: P00, P11, P22, P23.
  Vec4f projectionTerms() const;
  Eigen::Matrix3f rotation() const { return view.topLeftCorner<3, 3>(); }
  /// A world direction in camera space.
  Vec3f direction(const Vec3f& world) const { return fromEigen(rotation() * toEigen(world)); }
  Vec3f point(const Vec3f& world) const;
};

/// A camera whose near and far planes hold all of `content` that is in front of it. Throws a scene Error if
/// eye and target are one point, or the field of view is not in (0, 180).
Camera makeCamera(const CameraPose& pose, float aspectRatio, const Aabb& content);

/// The sun's view of all that casts shadows: a parallel projection onto a square.
struct SunView {
  Eigen::Matrix4f view;                ///< from world to sun space; the sun shines along -z
  float halfSize = 1;                  ///< m; the square holds x and y in ±halfSize
  float zNearest = 0, zFarthest = -1;  ///< of the casters in sun space, m

  /// World to texture coordinates and depth, all in [0, 1].
  Eigen::Matrix4f toTexture() const;
  /// World to clip space.
  Eigen::Matrix4f toClip() const;
};

/// The square's size goes in steps and its place in whole texels, so that shadows of a slowly growing scene
/// do not swim.
SunView makeSunView(const Vec3f& towardsSun, const Aabb& casters, int resolution);

}  // namespace weir::rendering::gl
