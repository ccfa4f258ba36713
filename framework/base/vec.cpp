#include "framework/base/vec.h"

#include <Eigen/Geometry>
#include <numbers>

namespace weir {

Quatf quaternionFromEulerDegrees(const Vec3f& degrees) {
  const double radians = std::numbers::pi / 180.0;
  const Eigen::Quaterniond q = Eigen::AngleAxisd(degrees.z * radians, Eigen::Vector3d::UnitZ()) *
                               Eigen::AngleAxisd(degrees.y * radians, Eigen::Vector3d::UnitY()) *
                               Eigen::AngleAxisd(degrees.x * radians, Eigen::Vector3d::UnitX());
  return {float(q.w()), float(q.x()), float(q.y()), float(q.z())};
}

}  // namespace weir
