// Motion against a drag that is proportional to speed, exactly, for steps of any length.
#pragma once

#include <cmath>

#include "framework/base/host_device.h"
#include "framework/base/vec.h"

namespace weir {

struct Motion {
  Vec3f position, velocity;  // m, m/s
};

namespace detail {

/// (1 − e⁻ᶻ)/z
WEIR_HD inline float firstPhi(float z) {
  constexpr float kSmall = 1e-6f;
  return z > kSmall ? -expm1f(-z) / z : 1.0f;
}
/// (z − 1 + e⁻ᶻ)/z²
WEIR_HD inline float secondPhi(float z) {
  constexpr float kSmall = 0.2f;  // below, the difference loses digits, and the series has them all
  if (z > kSmall) return (z + expm1f(-z)) / (z * z);
  return 0.5f - z * (1 / 6.0f - z * (1 / 24.0f - z * (1 / 120.0f - z / 720)));
}

}  // namespace detail

/// After dt seconds of dv/dt = a − rate·v, dx/dt = v; with z = rate·dt and φ1, φ2 as above
///
///   v(dt) = v + dt·φ1(z)·(a − rate·v)        x(dt) = x + dt·v + dt²·φ2(z)·(a − rate·v)
WEIR_HD inline Motion dragged(const Motion& start, const Vec3f& acceleration, float rate, float dt) {
  const float z = rate * dt;
  const Vec3f change = acceleration - rate * start.velocity;
  return {start.position + dt * start.velocity + (dt * dt * detail::secondPhi(z)) * change,
          start.velocity + (dt * detail::firstPhi(z)) * change};
}

}  // namespace weir
