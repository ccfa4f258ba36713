#include "nodes/particle_fluid/particle_fluid.h"
#include "nodes/particle_fluid/density.h"

namespace weir {

namespace {

struct PointBox {
  ArrayView<const Vec3f> positions;
  WEIR_HD Aabb operator()(std::int64_t i) const {
    const Vec3f p = positions[i];
    // A particle that is no longer finite must not spoil the box of the others.
    return isFinite(p) ? Aabb{p, p} : Aabb{};
  }
};

struct UniteBoxes {
  WEIR_HD Aabb operator()(const Aabb& a, const Aabb& b) const { return {min(a.lo, b.lo), max(a.hi, b.hi)}; }
};

struct SpeedSquared {
  ArrayView<const Vec3f> velocities;
  WEIR_HD float operator()(std::int64_t i) const {
    const Vec3f v = velocities[i];
    // Particles that are no numbers are removed and counted elsewhere.
    return isFinite(v) ? dot(v, v) : 0.0f;
  }
};

struct Larger {
  WEIR_HD float operator()(float a, float b) const { return a > b ? a : b; }
};

struct Density {
  NeighborView neighbors;
  SpikyKernel kernel;
  float particleVolume, restDensity;
  ArrayView<const Vec3f> positions;
  WallFieldView walls;
  ArrayView<float> density;

  WEIR_HD void operator()(std::int64_t i) const {
    float lambda = relativeDensity(i, neighbors, kernel, particleVolume,
                                   [this](std::int64_t j) { return positions[j]; });
    if (!walls.empty()) lambda += walls.phi(i, {});
    density[i] = restDensity * lambda;
  }
};

}  // namespace

template <class Backend>
void ParticleFluid::boundingBoxOn(Backend& device) {
  State& state = *state_;
  reduce(device, "bounding box", state.particles.count(), Aabb{},
         PointBox{state.particles.positions().view()}, UniteBoxes{}, state.box.data());
}

template <class Backend>
void ParticleFluid::speedOn(Backend& device) {
  State& state = *state_;
  reduce(device, "largest speed", state.particles.count(), 0.0f,
         SpeedSquared{state.particles.velocities().view()}, Larger{}, state.speedSquared.data());
}

template <class Backend>
void ParticleFluid::densityOn(Backend& device) {
  State& state = *state_;
  parallelFor(
      device, "density", state.particles.count(),
      Density{state.neighbors.view(), constants_.kernel, constants_.particleVolume, constants_.restDensity,
              state.particles.positions().view(), state.walls.view(), state.density->view()});
}

template void ParticleFluid::boundingBoxOn(ThisBackend&);
template void ParticleFluid::speedOn(ThisBackend&);
template void ParticleFluid::densityOn(ThisBackend&);

}  // namespace weir
