#include "nodes/particle_fluid/modules/boundary_collision.h"

#include "framework/compute/eight.h"
#include "nodes/particle_fluid/boundary_contact.h"
#include "nodes/particle_fluid/boundary_forces.h"

namespace weir {

template <class Backend>
void BoundaryCollision::stepOn(Backend& device, FluidStep& fluid) {
  addPressureImpulses(device, fluid);
  addContactImpulses(device, fluid, [&] { contactOn(device, fluid); });
}

template <class Backend>
void BoundaryCollision::contactOn(Backend& device, FluidStep& fluid) {
  const Count count = fluid.particles.count();
  const ArrayView<Vec3f> positions = fluid.particles.positions().write(),
                         velocities = fluid.particles.velocities().write();
  if (fluid.walls.rubs)
    parallelForEights(device, "wall_friction", count,
                      WallFriction{.walls = fluid.walls.boundary,
                                   .inverseDt = 1 / static_cast<float>(fluid.time.dt),
                                   .positions = positions,
                                   .share = fluid.walls.share.read(),
                                   .velocities = velocities});
  parallelForEights(device, "collide", count,
                    Collide{fluid.walls.boundary.boundary, fluid.constants.contact, positions, velocities});
}

template void BoundaryCollision::stepOn(ThisBackend&, FluidStep&);

}  // namespace weir
