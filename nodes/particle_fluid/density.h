// λ = ρ/ρ0 = V0·Σ_j W(r_ij), the particle itself included (paper, Eq. 6).
#pragma once

#include <cmath>
#include <concepts>

#include "framework/base/api.h"
#include "framework/neighbors/neighbor_sum.h"
#include "nodes/particle_fluid/fluid_constants.h"

namespace WEIR_API weir {

/// `position(j)` gives a Vec3f.
template <std::invocable<std::int64_t> Position>
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

/// The same with positions that are the first three numbers of `state`, of one or eight particles.
template <class Index>
WEIR_HD NumberAt<Index> relativeDensity(Index i, const NeighborView& neighbors, const SpikyKernel& kernel,
                                        float particleVolume, const ArrayView<const Vec4f>& state) {
  const auto list = neighborsOf(i, neighbors);
  const auto s = read(state, i);
  const auto value = [&]<class T>(const auto&, const Vec4<T>& t) {
    const Vec3<T> d{t.x - s.x, t.y - s.y, t.z - s.z};
    return kernel.value(fastSqrt(dot(d, d)));
  };
  return particleVolume * (kernel.value0 + sumOverNeighbors<float>(list, value, state));
}

}  // namespace weir
