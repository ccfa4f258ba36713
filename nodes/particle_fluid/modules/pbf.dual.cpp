#include "nodes/particle_fluid/modules/pbf.h"

#include "nodes/particle_fluid/displacement.h"
#include "nodes/particle_fluid/scratch.h"
#include "nodes/particle_fluid/wall_field.h"

namespace weir {

namespace {

/// What both passes know of a pair.
struct PairGradient {
  SpikyKernel kernel;
  float particleVolume;
  float shortest;  // m; closer pairs are treated as this far apart, along their direction

  /// g_ij for d = x_i − x_j. Particles in one place would stay there for ever, so `sign`, opposite for the
  /// two, then gives the direction.
  WEIR_HD Vec3f operator()(Vec3f d, float sign) const {
    float r = sqrtf(dot(d, d));
    if (r < shortest) {
      if (r == 0) d.x = sign * shortest;
      r = shortest;
    }
    return (-particleVolume * kernel.slope(r) / r) * d;
  }
};

WEIR_HD float pairSign(std::int64_t i, int j) {
  return j > i ? -1.0f : 1.0f;
}

struct Multiplier {
  NeighborView neighbors;
  PairGradient gradient;
  float relaxation;  // ε, 1/m²
  float scale;       // of the step
  bool tension;
  WallFieldView walls;
  ArrayView<const Vec3f> displacement;
  ArrayView<const Vec4f> state;
  ArrayView<Vec4f> weighted;

  WEIR_HD void operator()(std::int64_t i) const {
    const Vec3f p = xyz(state[i]);
    float density = gradient.kernel.value0, squares = 0;
    Vec3f sum{};
    forEachNeighbor(i, neighbors, [&](int j) {
      const Vec3f d = p - xyz(state[j]);
      density += gradient.kernel.value(sqrtf(dot(d, d)));
      const Vec3f g = gradient(d, pairSign(i, j));
      squares += dot(g, g);
      sum += g;
    });
    float over = gradient.particleVolume * density - 1;
    if (!walls.empty()) {
      over += walls.phi(i, displacement[i], p);
      sum += walls.push(i, p).gradPhi;
    }
    const float constraint = tension || over > 0 ? over : 0.0f;
    weighted[i] = {p.x, p.y, p.z, -scale * constraint / (squares + dot(sum, sum) + relaxation)};
  }
};

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
      const Vec3f d = xyz(s) - xyz(t);
      const float w = gradient.kernel.value(sqrtf(dot(d, d))) * inverseValue;
      move += (s.w + t.w - repulsion * w * w * w * w) * gradient(d, pairSign(i, j));
    });
    if (!walls.empty()) {
      move += s.w * walls.push(i, xyz(s)).gradPhi;
      if (walls.share.size > 0) walls.share[i] += s.w;
    }
    const Vec3f moved = displacement[i] + move;
    displacement[i] = moved;
    const Vec3f p = predicted[i] + moved;
    state[i] = {p.x, p.y, p.z, 0};
  }
};

}  // namespace

template <class Backend>
void Pbf::stepOn(Backend& device, FluidStep& fluid) {
  fitScratch(fluid, state_, weighted_, displacement_);
  constexpr float kShortest = 1e-4f;            // spacings
  constexpr float kRepulsionDistance = 0.2f;    // support radii
  constexpr float kUnnormalizedEpsilon = 0.1f;  // 1/m⁸
  const Count count = fluid.particles.count();
  const FluidConstants& c = fluid.constants;
  const bool textbook = form == PbfForm::kTextbook;
  const float area = c.spacing * c.spacing;
  const auto positions = fluid.particles.positions().write().view();
  const WallFieldView walls = fluid.walls.view();
  const PairGradient gradient{c.kernel, c.particleVolume, kShortest * c.spacing};
  const Multiplier multiplier{
      fluid.neighbors.view(),
      gradient,
      textbook ? epsilon / area : kUnnormalizedEpsilon * c.particleVolume * c.particleVolume,
      textbook ? 1.0f : stepFactor * c.particleMass,
      tension,
      walls,
      displacement_.view(),
      state_.view(),
      weighted_.view()};
  const Correct correct{fluid.neighbors.view(),
                        gradient,
                        textbook ? artificialPressure * area : 0.0f,
                        1 / c.kernel.value(kRepulsionDistance * c.supportRadius),
                        walls,
                        positions,
                        weighted_.view(),
                        displacement_.view(),
                        state_.view()};

  fluid.walls.forgetShares();
  parallelFor(device, "start", count, StartDisplacement{positions, state_.view(), displacement_.view()});
  if (recordObjective) objective_->begin(fluid, iterations + 1);
  fluid.exchange(state_.view());
  record(fluid);
  for (int k = 0; k < iterations; ++k) {
    parallelFor(device, "multipliers", count, multiplier);
    fluid.exchange(weighted_.view());
    parallelFor(device, "correct", count, correct);
    fluid.exchange(state_.view());
    record(fluid);
  }
  parallelFor(device, "finish", count,
              FinishDisplacement{1 / static_cast<float>(fluid.time.dt), displacement_.view(), positions,
                                 fluid.particles.velocities().write()});
}

template void Pbf::stepOn(ThisBackend&, FluidStep&);

}  // namespace weir
