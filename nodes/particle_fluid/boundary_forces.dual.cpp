#include "nodes/particle_fluid/boundary_forces.h"

#include "nodes/particle_fluid/fluid_sums.h"
#include "nodes/particle_fluid/solid_collision.h"

namespace weir {

namespace {

using Measured = WallField::Measured;

/// Gives the boundary k what fluid at p does to it, and the same to those of its parts in whose boxes p is.
template <class Give, class Impulse>
WEIR_HD void giveWithParts(const ArrayView<const Measured>& measured, int k, const Vec3f& p, const Give& give,
                           const Impulse& impulse) {
  give(k, impulse);
  for (int part = k + 1; part <= k + measured[k].parts; ++part)
    if (measured[part].box.contains(p)) give(part, impulse);
}

struct PressureOnBoundaries {
  BoundaryIntegrals walls;
  ArrayView<const Measured> measured;
  float massPerDt;  // kg/s
  ArrayView<const Vec3f> positions;
  ArrayView<const float> share;

  template <class Give>
  WEIR_HD void operator()(std::int64_t i, const Give& give) const {
    const float s = share[i];
    if (s == 0) return;
    const Vec3f p = positions[i];
    if (!mayTouch(walls.boundary, walls.radius, p)) return;
    walls.forEachPart(p, [&](const BoundaryPiece& piece, const Vec3f& gradient) {
      const int k = piece.measured;
      if (k < 0) return;
      giveWithParts(measured, k, p, give,
                    [&] { return impulseAt(-massPerDt * s * gradient, p - measured[k].pivot); });
    });
  }
};

struct ContactWithBoundaries {
  BoundaryView boundary;
  ArrayView<const Measured> measured;
  float mass;
  ArrayView<const Vec3f> positions, before, velocities;

  template <class Give>
  WEIR_HD void operator()(std::int64_t i, const Give& give) const {
    const Vec3f change = velocities[i] - before[i], p = positions[i];
    if (change == Vec3f{}) return;
    const int k = nearest(p);
    if (k < 0) return;
    giveWithParts(measured, k, p, give, [&] { return impulseAt(-mass * change, p - measured[k].pivot); });
  }

  WEIR_HD int nearest(const Vec3f& p) const {
    float min = 0;
    int result = -1;
    bool any = false;
    forEachPiece(boundary, [&](const BoundaryPiece& piece) {
      const float distance = piece.query(p).distance;
      if (any && !(distance < min)) return;
      any = true, min = distance, result = piece.measured;
    });
    return result;
  }
};

struct AddToBoundary {
  ArrayView<const Measured> measured;
  ArrayView<const SolidImpulse> sums;
  WEIR_HD void operator()(std::int64_t k) const { *measured[k].impulse += sums[k]; }
};

struct KeepVelocity {
  ArrayView<const Vec3f> velocities;
  ArrayView<Vec3f> kept;
  WEIR_HD void operator()(std::int64_t i) const { kept[i] = velocities[i]; }
};

template <class Backend, class Impulses>
void addImpulses(Backend& device, FluidStep& fluid, const Impulses& impulses) {
  WallField& walls = fluid.walls;
  const std::int64_t boundaries = walls.measured.size();
  sumByKeyOverRanks(device, "boundary impulse", allOf(fluid), boundaries, impulses, AddImpulses{},
                    walls.boundaryImpulses.data());
  parallelFor(
      device, "add impulses", boundaries,
      AddToBoundary{std::as_const(walls.measured).view(), std::as_const(walls.boundaryImpulses).view()});
}

}  // namespace

template <class Backend>
void addPressureImpulses(Backend& device, FluidStep& fluid) {
  WallField& walls = fluid.walls;
  if (!walls.reports()) return;
  addImpulses(
      device, fluid,
      PressureOnBoundaries{.walls = walls.boundary,
                           .measured = std::as_const(walls.measured).view(),
                           .massPerDt = fluid.constants.particleMass / static_cast<float>(fluid.time.dt),
                           .positions = fluid.particles.positions().read(),
                           .share = walls.share.read()});
}

template <class Backend>
void keepVelocities(Backend& device, FluidStep& fluid) {
  Array<Vec3f>& kept = fluid.walls.velocitiesBefore;
  kept.resizeDiscarding(fluid.particles.capacity());
  parallelFor(device, "keep velocities", fluid.particles.count(),
              KeepVelocity{fluid.particles.velocities().read(), kept.view()});
}

template <class Backend>
void addChangesOfVelocity(Backend& device, FluidStep& fluid) {
  WallField& walls = fluid.walls;
  addImpulses(device, fluid,
              ContactWithBoundaries{.boundary = walls.boundary.boundary,
                                    .measured = std::as_const(walls.measured).view(),
                                    .mass = fluid.constants.particleMass,
                                    .positions = fluid.particles.positions().read(),
                                    .before = std::as_const(walls.velocitiesBefore).view(),
                                    .velocities = fluid.particles.velocities().read()});
}

template void addPressureImpulses(ThisBackend&, FluidStep&);
template void keepVelocities(ThisBackend&, FluidStep&);
template void addChangesOfVelocity(ThisBackend&, FluidStep&);

}  // namespace weir
