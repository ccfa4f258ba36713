// V0·∇_i W of a pair of particles.
#pragma once

#include "nodes/particle_fluid/fluid_constants.h"

namespace weir {

/// g_ij = V0·|W'|/r·r_ij for r_ij = x_j − x_i.
struct PairGradient {
  SpikyKernel kernel;
  float particleVolume;
  float shortest;  ///< m; closer pairs are treated as this far apart, along their direction

  /// Particles in one place would stay there for ever, so `sign`, opposite for the two, then gives the
  /// direction.
  WEIR_HD Vec3f operator()(Vec3f r, float sign) const {
    float far = sqrtf(dot(r, r));
    if (far == 0) r.x = sign * shortest;
    return weight(far) * r;
  }
  /// V0·|W'|/r
  WEIR_HD float weight(float far) const {
    if (far < shortest) far = shortest;
    return particleVolume * kernel.slope(far) / far;
  }
};

WEIR_HD inline float pairSign(std::int64_t i, int j) {
  return j > i ? 1.0f : -1.0f;
}

/// With kernels as wide as the fluid's.
inline PairGradient pairGradientOf(const FluidConstants& c) {
  constexpr float kShortest = 1e-4f;  // spacings
  return {c.kernel, c.particleVolume, kShortest * c.spacing};
}

}  // namespace weir
