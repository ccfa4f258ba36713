// What the passes of TwoProjections (two_projections.h) know of each particle, and sums over its pairs.
#pragma once

#include "framework/base/symmetric_tensor.h"
#include "nodes/particle_fluid/density.h"
#include "nodes/particle_fluid/displacement.h"
#include "nodes/particle_fluid/modules/projection_mirrors.h"

namespace weir {

/// Of moments, made regular where neighbours are few or lie in a plane.
WEIR_HD inline SymmetricTensor inverseOf(SymmetricTensor m) {
  constexpr float kLeastDeterminant = 0.1f, kLeastMean = 0.25f;  // both are about 1 inside the fluid
  const float mean = (m.diagonal.x + m.diagonal.y + m.diagonal.z) / 3;
  const float flat = 1 - m.determinant() / (mean * mean * mean + 1e-12f) / kLeastDeterminant;
  float more = mean < kLeastMean ? kLeastMean - mean : 0.0f;
  if (flat > 0) more += 0.5f * (flat < 2 ? flat : 2.0f) * (mean > 0.3f ? mean : 0.3f);
  m.diagonal += Vec3f{more, more, more};
  const Vec3f d = m.diagonal, o = m.off;
  const float scale = 1 / m.determinant();
  return {scale * Vec3f{d.y * d.z - o.z * o.z, d.x * d.z - o.y * o.y, d.x * d.y - o.x * o.x},
          scale * Vec3f{o.y * o.z - o.x * d.z, o.x * o.z - o.y * d.y, o.x * o.y - o.z * d.x}};
}

/// All that the passes know of the particles at the beginning of a step.
struct ProjectionPacking {
  NeighborView neighbors;
  PairGradient gradient;
  ArrayView<const Vec4f> state;
  ArrayView<const Vec3f> wallDistances;  ///< NearWalls
  ArrayView<const float> wallKeys;
  ArrayView<const Vec3f> diagonal, off, wall;

  WEIR_HD SymmetricTensor tensor(std::int64_t i) const { return {diagonal[i], off[i]}; }
  WEIR_HD projection::NearWalls nearWalls(std::int64_t i) const { return {wallDistances[i], wallKeys[i]}; }
  /// f(j, a·r, r) of all neighbours.
  template <class F>
  WEIR_HD void forEach(std::int64_t i, const F& f) const {
    const Vec3f p = xyz(state[i]);
    const projection::NearWalls own = nearWalls(i);
    forEachNeighbor(i, neighbors, [&](int j) {
      const Vec3f r = xyz(state[j]) - p;
      Vec3f g = gradient(r, pairSign(i, j));
      if (own.key[0] != 0 && wallKeys[j] > 0)
        g += projection::mirroredWeight(gradient, dot(r, r), own, nearWalls(j)) * r;
      f(j, g, r);
    });
  }
};

}  // namespace weir
