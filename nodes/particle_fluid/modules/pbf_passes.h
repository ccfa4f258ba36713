// The two passes of an iteration of position based fluids (pbf.h).
#pragma once

#include "framework/neighbors/neighbor_sum.h"
#include "nodes/particle_fluid/displacement.h"
#include "nodes/particle_fluid/pair_gradient.h"
#include "nodes/particle_fluid/wall_field.h"

namespace weir::pbf {

/// ℓ of each particle, beside its position.
struct Multiplier {
  NeighborView neighbors;
  PairGradient gradient;
  float relaxation;  // ε, 1/m²
  float scale;       // of the step
  bool tension;
  WallFieldView walls;
  ArrayView<const Vec4f> state;
  ArrayView<Vec4f> weighted;

  WEIR_HD void operator()(std::int64_t i) const {
    const Vec3f p = xyz(state[i]);
    float density = gradient.kernel.value0, squares = 0;
    Vec3f sum{};
    forEachNeighbor(i, neighbors, [&](int j) {
      const Vec3f r = xyz(state[j]) - p;
      density += gradient.kernel.value(sqrtf(dot(r, r)));
      const Vec3f g = gradient(r, pairSign(i, j));
      squares += dot(g, g);
      sum += g;
    });
    float over = gradient.particleVolume * density - 1;
    if (!walls.empty()) {
      over += walls.phi(i, p);
      sum += walls.push(i, p).gradPhi;
    }
    const float constraint = tension || over > 0 ? over : 0.0f;
    weighted[i] = {p.x, p.y, p.z, -scale * constraint / (squares + dot(sum, sum) + relaxation)};
  }
};

/// Moves particles by the multipliers.
struct Correct {
  NeighborView neighbors;
  PairGradient gradient;
  float repulsion;     // k, m²
  float inverseValue;  // 1/W(0.2·H)
  WallFieldView walls;
  ArrayView<const Vec3f> predicted;
  ArrayView<const Vec4f> weighted;
  ArrayView<Vec3f> displacement;
  ArrayView<Vec4f> state;

  WEIR_HD void operator()(std::int64_t i) const {
    const Vec4f s = weighted[i];
    Vec3f move{};
    forEachNeighbor(i, neighbors, [&](int j) {
      const Vec4f t = weighted[j];
      const Vec3f r = xyz(t) - xyz(s);
      const float w = gradient.kernel.value(sqrtf(dot(r, r))) * inverseValue;
      move += (s.w + t.w - repulsion * w * w * w * w) * gradient(r, pairSign(i, j));
    });
    if (!walls.empty()) {
      const WallPush<float> wall = walls.push(i, xyz(s));
      move += s.w * wall.gradPhi;
      if (walls.share.size > 0) walls.share[i] += s.w * wall.steepness;
    }
    const Vec3f moved = displacement[i] + move;
    displacement[i] = moved;
    const Vec3f p = predicted[i] + moved;
    state[i] = {p.x, p.y, p.z, 0};
  }
};

}  // namespace weir::pbf
