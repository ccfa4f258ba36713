// The spiky kernel (Debrun's, paper Eq. 9 with the radius to the third power corrected by its normalisation)
//
//   W(r)  =  s·15/(πH³)·(1 − r/H)³      W'(r) = −s·45/(πH⁴)·(1 − r/H)²      for r < H, zero beyond
//
// where s is the calibration of the rest state, see fluid_constants.h.
#pragma once

#include "framework/base/api.h"
#include "framework/compute/lanes.h"

namespace WEIR_API weir {

struct SpikyKernel {
  float inverseRadius = 0;  ///< 1/H, 1/m
  float value0 = 0;         ///< W(0), 1/m³
  float slope0 = 0;         ///< |W'(0)|, 1/m⁴

  SpikyKernel() = default;
  SpikyKernel(float radius, float calibration)
      : inverseRadius(1 / radius),
        value0(calibration * 15 / (kPi * radius * radius * radius)),
        slope0(calibration * 45 / (kPi * radius * radius * radius * radius)) {}

  /// W at distance r in [0, H], or at eight of them.
  template <class T>
  WEIR_HD T value(const T& r) const {
    const T t = clampedRest(r);
    return value0 * t * t * t;
  }
  /// |W'| at distance r in [0, H].
  template <class T>
  WEIR_HD T slope(const T& r) const {
    const T t = clampedRest(r);
    return slope0 * t * t;
  }

 private:
  static constexpr float kPi = 3.14159265358979f;

  template <class T>
  WEIR_HD T clampedRest(const T& r) const {
    // A neighbour found at the predicted positions may leave the support during the iterations.
    return positivePart(1 - r * inverseRadius);
  }
};

}  // namespace weir
