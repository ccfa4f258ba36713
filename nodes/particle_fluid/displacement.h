// What solvers share that move particles by displacements from their predicted positions.
#pragma once

#include "framework/base/api.h"
#include "framework/base/vec.h"
#include "framework/compute/array.h"

namespace WEIR_API weir {

template <class T>
WEIR_HD Vec3<T> xyz(const Vec4<T>& v) {
  return {v.x, v.y, v.z};
}

/// Every particle at its predicted place.
struct StartDisplacement {
  ArrayView<const Vec3f> predicted;
  ArrayView<Vec4f> state;  ///< position, and a number that the solver gives a meaning
  ArrayView<Vec3f> displacement;

  WEIR_HD void operator()(std::int64_t i) const {
    const Vec3f p = predicted[i];
    state[i] = {p.x, p.y, p.z, 0};
    displacement[i] = {};
  }
};

/// x = x* + u and v = v* + u/dt.
struct FinishDisplacement {
  float inverseDt;
  ArrayView<const Vec3f> displacement;
  ArrayView<Vec3f> positions, velocities;

  WEIR_HD void operator()(std::int64_t i) const {
    positions[i] += displacement[i];
    velocities[i] += inverseDt * displacement[i];
  }
};

}  // namespace weir
