// What of a fluid makes white water, and how much: kernels. The potentials are those of white_water.h.
#pragma once

#include "nodes/white_water/draws.h"
#include "nodes/white_water/fluid_grid.h"
#include "nodes/white_water/fluid_walls.h"

namespace weir {

/// 0 up to the lower end, 1 from the upper end on, linear between.
struct Ramp {
  float low, high;
  WEIR_HD float operator()(float x) const {
    const float share = (x - low) / (high - low);
    return share > 0 ? (share < 1 ? share : 1.0f) : 0.0f;
  }
};

/// Cells with fluid that is faster than the limit. Elsewhere nothing is made, so nothing has to be found.
struct MarkFast {
  FluidGridView fluid;
  float limit;  // m²/s²
  ArrayView<std::uint8_t> fast;

  WEIR_HD void operator()(std::int64_t cell) const {
    std::uint8_t any = 0;
    for (int k = fluid.start[cell]; k < fluid.start[cell + 1] && any == 0; ++k)
      any = dot(fluid.velocities[k], fluid.velocities[k]) > limit ? 1 : 0;
    fast[cell] = any;
  }
};

/// The unit vector out of the fluid at place k where there is a surface, and fast fluid is near; or else 0.
struct FindNormal {
  FluidGridView fluid;
  FluidWalls walls;
  ArrayView<const std::uint8_t> fast;
  ArrayView<Vec3f> normals;

  WEIR_HD void operator()(std::int64_t k) const {
    normals[k] = {};
    const Vec3f p = xyz(fluid.places[k]);
    bool wanted = false;
    fluid.forEachCellRow(p, [&](int first, int last) {
      for (int cell = first; cell <= last; ++cell) wanted = wanted || fast[cell] != 0;
    });
    if (!wanted) return;
    Vec3f towardsFluid;
    fluid.forEachNear(p, [&](int j, const Vec3f& away, float squared) {
      const float rest = 1 - squared / (fluid.radius * fluid.radius);
      towardsFluid += (fluid.places[j].w * rest * rest) * away;
    });
    // A flat surface has 315/256 at it, and half of that at 0.4 H below.
    constexpr float kSurface = 0.55f;
    const float h = fluid.radius, steepness = (6 / h) * fluid.factor() * length(towardsFluid);
    if (steepness > kSurface && !walls.isNear(p, h)) normals[k] = -normalized(towardsFluid);
  }
};

/// How many the fluid's particle at place k makes in a step.
struct CountBorn {
  FluidGridView fluid;
  ArrayView<const int> order;
  ArrayView<const Vec3f> normals;     // empty where crests make nothing
  ArrayView<const std::int64_t> ids;  // of this rank's particles, behind which are those of others
  Ramp energy, air, crest;            // of m²/s², m/s, 1/m
  float airRate, crestRate;           // 1/(m² s)
  float dt, max;
  std::uint64_t seed;
  std::int64_t step;
  ArrayView<float> filled;
  ArrayView<int> born;

  WEIR_HD void operator()(std::int64_t k) const {
    const Vec3f v = fluid.velocities[k];
    const float fast = energy(dot(v, v));
    const int i = order[k];
    if (!(fast > 0) || i >= filled.size) return;
    const Vec3f p = xyz(fluid.places[k]);
    float around = 0, whirl = 0;
    fluid.forEachNear(p, [&](int j, const Vec3f& away, float squared) {
      const float weight = fluid.places[j].w * fluid.shape(squared);
      around += weight;
      if (squared > 0) whirl += weight * whirlOf(v - fluid.velocities[j], away, squared);
    });
    filled[i] = fluid.factor() * around;
    const float rate = airRate * air(fluid.factor() * whirl) + crestRate * crest(curvature(k, p, v));
    const float volume = fluid.places[k].w, area = cbrtf(volume * volume);
    const float mean = area * dt * fast * rate;
    const float drawn = floorf((mean < max ? mean : max) + Draws(seed, ids[i], step, -1).next());
    born[i] = static_cast<int>(drawn < max ? drawn : max);
  }

  /// |v_ij|·(1 − v̂_ij·x̂_ij), with `away` from i to j.
  WEIR_HD static float whirlOf(const Vec3f& relative, const Vec3f& away, float squared) {
    return length(relative) + dot(relative, away) / sqrtf(squared);
  }

  WEIR_HD float curvature(std::int64_t k, const Vec3f& p, const Vec3f& v) const {
    if (normals.size == 0) return 0;
    constexpr float kForwards = 0.6f;
    const Vec3f n = normals[k];
    if (!(dot(v, n) > kForwards * length(v)) || dot(n, n) == 0) return 0;
    float bent = 0, all = 0;
    fluid.forEachNear(p, [&](int j, const Vec3f& away, float squared) {
      const Vec3f other = normals[j];
      if (dot(other, other) == 0) return;
      const float weight = fluid.places[j].w * fluid.shape(squared);
      bent += weight * dot(other - n, away);
      all += weight * squared;
    });
    return all > 0 ? bent / all : 0.0f;
  }
};

}  // namespace weir
