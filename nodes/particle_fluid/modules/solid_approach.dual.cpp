#include "nodes/particle_fluid/modules/solid_approach.h"

#include "framework/compute/parallel_uneven.h"
#include "nodes/particle_fluid/boundary_contact.h"
#include "nodes/particle_fluid/boundary_forces.h"
#include "nodes/particle_fluid/solid_collision.h"

namespace weir {

namespace {

struct MayMeet {
  ArrayView<const SolidView> solids;
  SolidGridView grid;
  float gap, dt;
  ArrayView<const Vec3f> positions, velocities;

  WEIR_HD bool operator()(std::int64_t i) const {
    const Vec3f p = positions[i];
    return !isClearOfSolids(solids, grid, false, gap, p - dt * velocities[i], p);
  }
};

struct StopOnTheWay {
  ArrayView<const SolidView> solids;
  SolidGridView grid;
  float gap, dt;
  ArrayView<const int> met;
  ArrayView<Vec3f> positions, velocities;
  ArrayView<Vec4f> kick;

  WEIR_HD void operator()(std::int64_t k) const {
    const int i = met[k];
    const Vec3f p = positions[i], v = velocities[i];
    const StoppedParticle after = stopAtSolids(solids, grid, false, gap, p - dt * v, p, v);
    const Vec3f change = after.velocity - v;
    kick[k] = {change.x, change.y, change.z, static_cast<float>(after.solid)};
    if (after.solid < 0) return;
    positions[i] = after.position;
    velocities[i] = after.velocity;
  }
};

}  // namespace

template <class Backend>
void SolidApproach::bounceOn(Backend& device, FluidStep& fluid) {
  constexpr double kSteps = 2;  // of a fall
  const double fall = length(fluid.time.gravity) * fluid.time.dt;
  addContactImpulses(device, fluid, [&] {
    const Collide collide{fluid.walls.boundary.boundary, fluid.constants.contact,
                          fluid.particles.positions().write(), fluid.particles.velocities().write()};
    parallelForEights(device, "bounce", fluid.particles.count(),
                      Bounce{collide, static_cast<float>(kSteps * fall)});
  });
}

template <class Backend>
void SolidApproach::stepOn(Backend& device, FluidStep& fluid) {
  WallField& walls = fluid.walls;
  walls.fit(fluid.particles);
  const ArrayView<const SolidView> solids = walls.views.view();
  const ArrayView<Vec3f> positions = fluid.particles.positions().write(),
                         velocities = fluid.particles.velocities().write();
  const float gap = kSolidGap * fluid.constants.spacing, dt = static_cast<float>(fluid.time.dt);
  const SolidGridView grid = walls.grid.view();
  walls.list(device, "may meet", fluid.particles.count(),
             MayMeet{solids, grid, gap, dt, positions, velocities}, walls.met, walls.metCounter);
  parallelForUneven(device, "approach", walls.metCount(),
                    StopOnTheWay{solids, grid, gap, dt, std::as_const(walls.met).view(), positions,
                                 velocities, walls.kick.view()});
  walls.listHits(device);
  shareKicks(device, fluid);
  sumContacts(device, fluid);
  giveImpulses(device, walls, 1);
}

template void SolidApproach::bounceOn(ThisBackend&, FluidStep&);
template void SolidApproach::stepOn(ThisBackend&, FluidStep&);

}  // namespace weir
