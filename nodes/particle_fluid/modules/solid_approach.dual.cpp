#include "nodes/particle_fluid/modules/solid_approach.h"

#include "nodes/particle_fluid/solid_collision.h"

namespace weir {

namespace {

struct StopOnTheWay {
  ArrayView<const SolidView> solids;
  float gap, dt;
  ArrayView<Vec3f> positions, velocities;
  ArrayView<Vec4f> kick;

  WEIR_HD void operator()(std::int64_t i) const {
    const Vec3f p = positions[i], v = velocities[i];
    const StoppedParticle after = stopAtSolids(solids, false, gap, p - dt * v, p, v);
    const Vec3f change = after.velocity - v;
    kick[i] = {change.x, change.y, change.z, static_cast<float>(after.solid)};
    if (after.solid < 0) return;
    positions[i] = after.position;
    velocities[i] = after.velocity;
  }
};

}  // namespace

template <class Backend>
void SolidApproach::stepOn(Backend& device, FluidStep& fluid) {
  WallField& walls = fluid.walls;
  const ArrayView<Vec3f> positions = fluid.particles.positions().view();
  walls.fit(fluid.particles);
  parallelFor(
      device, "approach", fluid.particles.count(),
      StopOnTheWay{walls.views.view(), kSolidGap * fluid.constants.spacing, static_cast<float>(fluid.time.dt),
                   positions, fluid.particles.velocities().view(), walls.kick.view()});
  for (std::size_t k = 0; k < walls.solids.size(); ++k) {
    const ContactImpulse contact{static_cast<int>(k),
                                 walls.solids[k]->pivotAt(fluid.time.time + fluid.time.dt),
                                 fluid.constants.particleMass, positions, walls.kick.view()};
    reduce(device, "impulse", fluid.particles.count(), SolidImpulse{}, contact, AddImpulses{},
           walls.impulse.data());
    parallelFor(device, "add impulse", 1,
                AddImpulse{walls.solids[k]->impulse().data(), walls.impulse.data()});
  }
}

template void SolidApproach::stepOn(ThisBackend&, FluidStep&);

}  // namespace weir
