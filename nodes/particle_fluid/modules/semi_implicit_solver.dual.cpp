#include "nodes/particle_fluid/modules/semi_implicit_solver.h"

#include "nodes/particle_fluid/density.h"

namespace weir {

namespace {

WEIR_HD Vec3f xyz(const Vec4f& v) {
  return {v.x, v.y, v.z};
}

struct Start {
  ArrayView<const Vec3f> predicted;
  ArrayView<Vec4f> state;
  ArrayView<Vec3f> displacement;

  WEIR_HD void operator()(std::int64_t i) const {
    const Vec3f p = predicted[i];
    state[i] = {p.x, p.y, p.z, 0};
    displacement[i] = {};
  }
};

/// Adds to each particle's state Ḃ(λ), the derivative of the bulk energy B0.
struct EnergyDerivative {
  NeighborView neighbors;
  SpikyKernel kernel;
  float particleVolume;
  bool tension;
  ArrayView<const Vec4f> state;
  ArrayView<Vec4f> weighted;

  WEIR_HD void operator()(std::int64_t i) const {
    const float lambda = relativeDensity(i, neighbors, kernel, particleVolume,
                                         [this](std::int64_t j) { return xyz(state[j]); });
    const float derivative = (tension || lambda > 1) ? lambda - 1 : 0.0f;
    const Vec4f s = state[i];
    weighted[i] = {s.x, s.y, s.z, derivative};
  }
};

struct Substitute {
  NeighborView neighbors;
  SpikyKernel kernel;
  float stiffness;    // (c·dt)²·V0
  float shortest;     // m; closer pairs are treated as this far apart, along their direction
  float own, others;  // weights of Ḃ_i and Ḃ_j
  ArrayView<const Vec3f> predicted;
  ArrayView<const Vec4f> weighted;
  ArrayView<Vec3f> displacement;
  ArrayView<Vec4f> state;

  WEIR_HD void operator()(std::int64_t i) const {
    const Vec4f s = weighted[i];
    Vec3f push{};
    float divisor = 0;
    forEachNeighbor(i, neighbors, [&](int j) {
      const Vec4f t = weighted[j];
      Vec3f d = xyz(t) - xyz(s);
      float r = sqrtf(dot(d, d));
      if (r < shortest) {
        // Particles in one place would stay there for ever; the sign makes the two directions opposite.
        if (r == 0) d.x = j > i ? shortest : -shortest;
        r = shortest;
      }
      const float a = stiffness * kernel.slope(r) / r;
      push -= (own * s.w + others * t.w) * a * d;
      divisor += a;
    });
    const Vec3f u = displacement[i];
    const Vec3f moved = u + (push - u) / (1 + (own + others) * divisor);
    displacement[i] = moved;
    const Vec3f p = predicted[i] + moved;
    state[i] = {p.x, p.y, p.z, 0};
  }
};

struct Finish {
  float inverseDt;
  ArrayView<const Vec3f> displacement;
  ArrayView<Vec3f> positions, velocities;

  WEIR_HD void operator()(std::int64_t i) const {
    positions[i] += displacement[i];
    velocities[i] += inverseDt * displacement[i];
  }
};

}  // namespace

template <class Backend>
void SemiImplicitSolver::stepOn(Backend& device, FluidStep& fluid) {
  reserve(fluid);
  constexpr float kShortest = 1e-4f;  // spacings
  const Count count = fluid.particles.count();
  const FluidConstants& c = fluid.constants;
  const float dt = static_cast<float>(fluid.time.dt);
  const NeighborView neighbors = fluid.neighbors.view();
  const EnergyDerivative derivative{neighbors, c.kernel,      c.particleVolume,
                                    tension,   state_.view(), weighted_.view()};
  const Substitute substitute{neighbors,
                              c.kernel,
                              c.soundSpeedSquared() * dt * dt * c.particleVolume,
                              kShortest * c.spacing,
                              1.0f,
                              conservative ? 1.0f : 0.0f,
                              fluid.particles.positions().view(),
                              weighted_.view(),
                              displacement_.view(),
                              state_.view()};

  parallelFor(device, "start", count,
              Start{fluid.particles.positions().view(), state_.view(), displacement_.view()});
  for (int k = 0; k < iterations; ++k) {
    parallelFor(device, "density", count, derivative);
    parallelFor(device, "substitute", count, substitute);
  }
  parallelFor(device, "finish", count,
              Finish{1 / dt, displacement_.view(), fluid.particles.positions().view(),
                     fluid.particles.velocities().view()});
}

template void SemiImplicitSolver::stepOn(ThisBackend&, FluidStep&);

}  // namespace weir
