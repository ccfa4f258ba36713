// A number kept between two bounds, on both back ends.
#pragma once

#include "framework/base/api.h"
#include "framework/base/host_device.h"

namespace WEIR_API weir {

/// NaN stays NaN.
WEIR_HD inline float clamped(float x, float low, float high) {
  return x < low ? low : (x > high ? high : x);
}

/// From 0 at `from` and below to 1 at `to` and above, without a kink.
WEIR_HD inline float smoothStep(float from, float to, float x) {
  const float t = clamped((x - from) / (to - from), 0, 1);
  return t * t * (3 - 2 * t);
}

}  // namespace weir
