// The number that stands for an attribute's element where there is room for one, as in colours and plots.
#pragma once

#include <cstdint>

#include "framework/base/mat3.h"

namespace weir {

WEIR_HD inline float singleNumber(float value) {
  return value;
}
WEIR_HD inline float singleNumber(int value) {
  return static_cast<float>(value);
}
WEIR_HD inline float singleNumber(std::int64_t value) {
  return static_cast<float>(value);
}
WEIR_HD inline float singleNumber(const Vec3f& value) {
  return length(value);
}
WEIR_HD inline float singleNumber(const Mat3f& value) {
  return frobeniusNorm(value);
}

}  // namespace weir
