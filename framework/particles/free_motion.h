// What particles do that feel nothing but a constant acceleration (paper, Algorithm 1, first loop).
#pragma once

#include <cmath>

#include "framework/base/api.h"
#include "framework/base/vec.h"

namespace WEIR_API weir {

/// v* = v + dt·g,  x* = x + dt·v*. Wherever it is written out, the same bits come out.
struct FreeMotion {
  Vec3f acceleration;
  float dt = 0;

  WEIR_HD Vec3f velocity(const Vec3f& v) const { return moved(v, acceleration); }
  /// With the new velocity.
  WEIR_HD Vec3f position(const Vec3f& p, const Vec3f& v) const { return moved(p, v); }

 private:
  WEIR_HD Vec3f moved(const Vec3f& from, const Vec3f& by) const {
#ifdef __CUDA_ARCH__
    return {fmaf(dt, by.x, from.x), fmaf(dt, by.y, from.y), fmaf(dt, by.z, from.z)};
#else
    return from + dt * by;
#endif
  }
};

}  // namespace weir
