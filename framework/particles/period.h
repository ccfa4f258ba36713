// Space that repeats itself along some axes: what leaves a box through one face comes in through the opposite
// one, and particles beside a face have neighbours beyond it.
#pragma once

#include <cmath>

#include "framework/base/api.h"
#include "framework/base/vec.h"

namespace WEIR_API weir {

/// The default one repeats along no axis.
struct Period {
  Vec3f lo;    ///< m, lower corner of the box
  Vec3f size;  ///< m, of the box, along each axis; 0 where space does not repeat

  WEIR_HD bool along(int axis) const { return size[axis] > 0; }
  WEIR_HD bool any() const { return along(0) || along(1) || along(2); }
  /// The finite place in the box, both faces included, that is as good as p.
  WEIR_HD Vec3f wrapped(Vec3f p) const {
    for (int axis = 0; axis < 3; ++axis)
      if (along(axis)) p[axis] = wrapped(p[axis], lo[axis], size[axis]);
    return p;
  }
  /// By how much an image is moved that is `turns` boxes away along each axis.
  WEIR_HD Vec3f shift(const Vec3i& turns) const {
    return {float(turns.x) * size.x, float(turns.y) * size.y, float(turns.z) * size.z};
  }
  friend bool operator==(const Period&, const Period&) = default;

 private:
  WEIR_HD static float wrapped(float x, float low, float length) {
    const float high = low + length;
    if (x >= low && x <= high) return x;
    x -= length * floorf((x - low) / length);
    // Rounding may leave it just beside a face.
    return x < low ? low : x > high ? high : x;
  }
};

/// Calls f(turns) for the box itself, {0, 0, 0}, and for all that touch it.
template <class F>
WEIR_HD void forEachImage(const Period& period, const F& f) {
  const int x = period.along(0) ? 1 : 0, y = period.along(1) ? 1 : 0, z = period.along(2) ? 1 : 0;
  for (int k = -z; k <= z; ++k)
    for (int j = -y; j <= y; ++j)
      for (int i = -x; i <= x; ++i) f(Vec3i{i, j, k});
}

}  // namespace weir
