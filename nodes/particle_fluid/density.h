// λ = ρ/ρ0 = V0·Σ_j W(r_ij), the particle itself included (paper, Eq. 6).
#pragma once

#include <cmath>

#include "nodes/particle_fluid/fluid_constants.h"
#include "nodes/particles/neighbor_list.h"

namespace weir {

/// `position(j)` gives a Vec3f.
template <class Position>
WEIR_HD inline float relativeDensity(std::int64_t i, const NeighborView& neighbors, const SpikyKernel& kernel,
                                     float particleVolume, const Position& position) {
  const Vec3f p = position(i);
  float sum = kernel.value0;
  forEachNeighbor(i, neighbors, [&](int j) {
    const Vec3f d = position(j) - p;
    sum += kernel.value(sqrtf(dot(d, d)));
  });
  return particleVolume * sum;
}

}  // namespace weir
