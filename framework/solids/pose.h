// Where a rigid body is: its own frame, turned and moved.
#pragma once

#include "framework/base/api.h"
#include "framework/base/vec.h"

namespace WEIR_API weir {

struct Pose {
  Quatf rotation;
  Vec3f translation;  ///< m

  WEIR_HD Vec3f toWorld(const Vec3f& p) const { return rotate(rotation, p) + translation; }
  WEIR_HD Vec3f toBody(const Vec3f& p) const { return rotate(conjugate(rotation), p - translation); }
  WEIR_HD Vec3f directionToWorld(const Vec3f& d) const { return rotate(rotation, d); }
  friend bool operator==(const Pose&, const Pose&) = default;
};

}  // namespace weir
