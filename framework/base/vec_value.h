// Vectors as values: lists of three numbers.
#pragma once

#include "framework/base/value.h"
#include "framework/base/vec.h"

namespace weir {

inline Value toValue(const Vec3d& v) {
  return Value::Array{v.x, v.y, v.z};
}

}  // namespace weir
