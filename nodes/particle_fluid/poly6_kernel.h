// The kernel of Müller et al. (2003), smooth at its centre:
//
//   W(r) = 315/(64πH³)·(1 − r²/H²)³      ∇_i W = −6·315/(64πH⁵)·(1 − r²/H²)²·(x_i − x_j)
//
// Its integral is 1. Beside the spiky kernel it reaches further, as attraction must beside a pressure.
#pragma once

#include "framework/base/vec.h"

namespace weir {

struct Poly6Kernel {
  float inverseSquare = 0;  ///< 1/H², 1/m²
  float value0 = 0;         ///< W(0), 1/m³

  Poly6Kernel() = default;
  explicit Poly6Kernel(float radius)
      : inverseSquare(1 / (radius * radius)), value0(315 / (64 * kPi * radius * radius * radius)) {}

  /// W for d = x_i − x_j.
  WEIR_HD float value(const Vec3f& d) const {
    const float t = clampedRest(d);
    return value0 * t * t * t;
  }
  /// ∇_i W for d = x_i − x_j; it points to j.
  WEIR_HD Vec3f gradient(const Vec3f& d) const {
    const float t = clampedRest(d);
    return (-6 * value0 * inverseSquare * t * t) * d;
  }

 private:
  static constexpr float kPi = 3.14159265358979f;

  WEIR_HD float clampedRest(const Vec3f& d) const {
    const float t = 1 - dot(d, d) * inverseSquare;
    return t > 0 ? t : 0;
  }
};

}  // namespace weir
