// What TwoProjections (two_projections.h) finds at the beginning of a step: N, and how fast fluid may close
// up.
#pragma once

#include "nodes/particle_fluid/modules/projection_packing.h"
#include "nodes/particle_fluid/modules/projection_walls.h"

namespace weir::projection {

/// x* − dt·v*.
struct Begin {
  float dt, toQ;
  ArrayView<const Vec3f> positions, velocities;
  ArrayView<const float> pressure;
  ArrayView<Vec4f> state;
  ArrayView<Vec3f> u;
  ArrayView<float> q;

  WEIR_HD void operator()(std::int64_t i) const {
    const Vec3f v = velocities[i], p = positions[i] - dt * v;
    state[i] = {p.x, p.y, p.z, 0};
    u[i] = v;
    q[i] = toQ * pressure[i];
  }
};

/// The walls that mirror a particle's pairs.
struct FindNearWalls {
  WallPlanes planes;
  ArrayView<const Vec4f> state;
  ArrayView<Vec3f> distances;
  ArrayView<float> keys;

  WEIR_HD void operator()(std::int64_t i) const {
    const NearWalls near = planes.near(i, xyz(state[i]));
    distances[i] = near.distances();
    keys[i] = near.keys();
  }
};

/// s: how fast fluid of that relative density may close up. What is compressed by more than corrections of
/// positions leave has to expand, as these reach a neighbour at a time.
WEIR_HD inline float roomFor(float lambda, float dt) {
  constexpr float kClosing = 0.02f;  // s, in which fluid just below rest density closes up
  constexpr float kCompressed = 0.003f;
  constexpr float kFree = 0.1f;  // what is further below does so as it likes
  const float below = 1 - lambda;
  if (below < -kCompressed) return (below + kCompressed) / kClosing;
  if (below < 0) return 0;
  return below / kClosing + (below > kFree ? (below - kFree) / dt : 0.0f);
}

/// N; w = Σ k·(n·N·n)·n over the planes of walls, and of each solid alone where bodies are moved; s less what
/// the walls' motion adds to D·v; and what walls carry: a pressure that grows with depth is at a wall not q
/// but q − y·n·(dt·g), at least 0 and at most 2·q.
struct FindMoments {
  ProjectionPacking packing;
  WallFieldView walls;
  WallPlanes planes;
  float dt;
  Vec3f fall;  // dt·g
  ArrayView<const Vec3f> velocities;
  ArrayView<const float> q;
  ArrayView<Vec3f> diagonal, off, wall, carried;
  ArrayView<Vec4f> wallOfPair;  // of BodiesAtParticles; empty where nobody asks for it
  ArrayView<float> room;

  WEIR_HD void operator()(std::int64_t i) const {
    const Vec3f p = xyz(packing.state[i]);
    SymmetricTensor moments{};
    const SpikyKernel& kernel = packing.gradient.kernel;
    float sum = kernel.value0;
    Vec3f all{};
    packing.forEach(i, [&](int, const Vec3f& g, const Vec3f& r) {
      all += g;
      const float far = sqrtf(dot(r, r));
      sum += kernel.value(far);
      if (far > 0) moments.addSquare(sqrtf(dot(g, g)) / far, r);
    });
    float lambda = packing.gradient.particleVolume * sum;
    if (!walls.empty()) lambda += positivePart(walls.phi(i, p) - planes.meshes.gained(i, dt));
    const PlanesAtParticle at = planes.at(i, p, all);
    at.forEach([&](const WallPlane& of) { moments.addSquare(of.push * of.distance, of.normal); });
    write(i, at, inverseOf(moments), lambda);
  }

 private:
  WEIR_HD void write(std::int64_t i, const PlanesAtParticle& at, const SymmetricTensor& n,
                     float lambda) const {
    Vec3f push{}, carries{};
    float moving = 0;
    if (wallOfPair.size > 0) forgetPairs(i);
    at.forEach([&](const WallPlane& of) {
      const float k = of.push * dot(of.normal, n * of.normal);
      push += k * of.normal;
      moving += k * dot(of.normal, of.velocity);
      const float more = clamped(-of.distance * dot(of.normal, fall), -q[i], q[i]);
      carries += k * more * of.normal;
      const Vec3f w = k * of.normal;
      if (of.pair >= 0 && wallOfPair.size > 0) wallOfPair[of.pair] = {w.x, w.y, w.z, more};
    });
    diagonal[i] = n.diagonal;
    off[i] = n.off;
    wall[i] = push;
    carried[i] = carries;
    room[i] = roomFor(lambda, dt) - moving;
  }
  WEIR_HD void forgetPairs(std::int64_t i) const {
    const SolidPairsView& pairs = planes.meshes.pairs;
    for (int pair = pairs.begin(i); pair < pairs.end(i); ++pair) wallOfPair[pair] = {};
  }
};

}  // namespace weir::projection
