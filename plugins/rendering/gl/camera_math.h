// Matrices of cameras, as OpenGL wants them: column vectors, looking along -z, depth from -1 to 1.
#pragma once

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "framework/base/vec.h"

namespace weir::rendering {

inline Eigen::Vector3f toEigen(const Vec3f& v) {
  return {v.x, v.y, v.z};
}

/// World to view space.
inline Eigen::Matrix4f lookAt(const Vec3f& eye, const Vec3f& target, const Vec3f& up) {
  const Eigen::Vector3f back = (toEigen(eye) - toEigen(target)).normalized();
  Eigen::Vector3f right = toEigen(up).cross(back);
  if (right.norm() < 1e-6f) right = back.unitOrthogonal();  // looking along `up`
  right.normalize();
  Eigen::Matrix4f m = Eigen::Matrix4f::Identity();
  m.block<1, 3>(0, 0) = right;
  m.block<1, 3>(1, 0) = back.cross(right);
  m.block<1, 3>(2, 0) = back;
  m.block<3, 1>(0, 3) = -m.block<3, 3>(0, 0) * toEigen(eye);
  return m;
}

/// `fov` is vertical, in degrees.
inline Eigen::Matrix4f perspective(float fov, float aspect, float near, float far) {
  const float f = 1 / std::tan(fov * std::numbers::pi_v<float> / 360);
  Eigen::Matrix4f m = Eigen::Matrix4f::Zero();
  m(0, 0) = f / aspect;
  m(1, 1) = f;
  m(2, 2) = -(far + near) / (far - near);
  m(2, 3) = -2 * far * near / (far - near);
  m(3, 2) = -1;
  return m;
}

/// The cube of half side `reach` around the axis, from 0 to `depth` in front.
inline Eigen::Matrix4f orthographic(float reach, float depth) {
  Eigen::Matrix4f m = Eigen::Matrix4f::Identity();
  m(0, 0) = m(1, 1) = 1 / reach;
  m(2, 2) = -2 / depth;
  m(2, 3) = -1;
  return m;
}

}  // namespace weir::rendering
