#include "nodes/particle_fluid/particle_fluid.h"
#include "framework/compute/reductions.h"
#include "framework/solids/carve.h"
#include "nodes/particle_fluid/density.h"

namespace weir {

namespace {

struct PointExtent {
  ArrayView<const Vec3f> positions;
  WEIR_HD FluidExtent operator()(std::int64_t i) const {
    const Vec3f p = positions[i];
    // A particle that is no longer finite must not spoil the box of the others.
    return isFinite(p) ? FluidExtent{{p, p}, p} : FluidExtent{};
  }
};

struct UniteExtents {
  WEIR_HD FluidExtent operator()(const FluidExtent& a, const FluidExtent& b) const {
    return {{min(a.box.lo, b.box.lo), max(a.box.hi, b.box.hi)}, a.sum + b.sum};
  }
};

struct SpeedSquared {
  ArrayView<const Vec3f> velocities;
  WEIR_HD float operator()(std::int64_t i) const {
    const Vec3f v = velocities[i];
    // Particles that are NaN or infinite are removed and counted elsewhere.
    return isFinite(v) ? dot(v, v) : 0.0f;
  }
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
    if (!walls.empty()) lambda += walls.phi(i, positions[i]);
    density[i] = restDensity * lambda;
  }
};

/// Fluid of n particles per volume has p = n·dE/dn with E = n·V0·K'·B(λ) minus what rest holds, and
/// dλ/dn = γ·λ/n (fluid_constants.h): p = γ·K'·λ·Ḃ(λ) where one particle fills V0.
struct Pressure {
  BulkEnergy energy;
  float restDensity, stiffness;  // γ·K'
  ArrayView<const float> density;
  ArrayView<float> pressure;

  WEIR_HD void operator()(std::int64_t i) const {
    const float lambda = density[i] / restDensity;
    pressure[i] = lambda > 1 ? stiffness * lambda * energy.derivative(lambda - 1) : 0.0f;
  }
};

/// Whether particles lie in a solid, or so near that there is no room for them.
struct MarkInside {
  ArrayView<const SolidView> solids;
  float gap;  // m
  ArrayView<const Vec3f> positions;
  ArrayView<int> inside;

  WEIR_HD void operator()(std::int64_t i) const {
    bool in = false;
    for (std::int64_t k = 0; k < solids.size && !in; ++k) in = hasNoRoom(solids[k], positions[i], gap);
    inside[i] = in ? 1 : 0;
  }
};

struct IsInside {
  ArrayView<const int> inside;
  WEIR_HD int operator()(std::int64_t i) const { return inside[i]; }
};

/// A cell of its own for each particle that has room, so that they keep their order.
struct RoomKey {
  ArrayView<const SolidView> solids;
  float gap;
  ArrayView<const Vec3f> positions;

  WEIR_HD int operator()(std::int64_t i) const {
    for (std::int64_t k = 0; k < solids.size; ++k) {
      if (!hasNoRoom(solids[k], positions[i], gap)) continue;
      atomicAdd(solids[k].carved, 1);
      return -1;
    }
    return static_cast<int>(i);
  }
};

}  // namespace

template <class Backend>
void ParticleFluid::selectOn(Backend& device, const ParticleBatch& born) {
  State& state = *state_;
  state.born.sort(
      device, born.count, static_cast<int>(born.count),
      RoomKey{std::as_const(state.walls.views).view(), kCarveGap * constants_.spacing, born.positions.view()},
      state.bornCount.data());
}

template <class Backend>
void ParticleFluid::markInsideOn(Backend& device, const Array<SolidView>& solids, Array<int>& inside) {
  const std::int64_t count = inside.size() - 1;
  parallelFor(device, "carve", count,
              MarkInside{solids.view(), kCarveGap * constants_.spacing, state_->particles.positions().read(),
                         inside.view()});
  reduce(device, "carve", count, 0, IsInside{std::as_const(inside).view()}, Plus{}, inside.data() + count);
}

template <class Backend>
void ParticleFluid::boundingBoxOn(Backend& device, ArrayView<const Vec3f> positions, const Count& count) {
  reduce(device, "bounding box", count, FluidExtent{}, PointExtent{positions}, UniteExtents{},
         state_->extent.data());
}

template <class Backend>
void ParticleFluid::speedOn(Backend& device) {
  State& state = *state_;
  reduce(device, "largest speed", state.particles.count(), 0.0f,
         SpeedSquared{state.particles.velocities().read()}, Max{}, state.speedSquared.data());
}

template <class Backend>
void ParticleFluid::densityOn(Backend& device) {
  State& state = *state_;
  parallelFor(
      device, "density", state.particles.count(),
      Density{state.neighbors.view(), constants_.kernel, constants_.particleVolume, constants_.restDensity,
              state.particles.positions().read(), state.walls.view(), state.density.write()});
}

template <class Backend>
void ParticleFluid::pressureOn(Backend& device) {
  State& state = *state_;
  const auto stiffness = static_cast<float>(settledResponse(supportRatio) * double(constants_.bulkModulus));
  parallelFor(device, "pressure", state.particles.count(),
              Pressure{bulkEnergy(), constants_.restDensity, stiffness, state.density.read(),
                       state.pressure.write()});
}

template void ParticleFluid::selectOn(ThisBackend&, const ParticleBatch&);
template void ParticleFluid::markInsideOn(ThisBackend&, const Array<SolidView>&, Array<int>&);
template void ParticleFluid::boundingBoxOn(ThisBackend&, ArrayView<const Vec3f>, const Count&);
template void ParticleFluid::speedOn(ThisBackend&);
template void ParticleFluid::densityOn(ThisBackend&);
template void ParticleFluid::pressureOn(ThisBackend&);

}  // namespace weir
