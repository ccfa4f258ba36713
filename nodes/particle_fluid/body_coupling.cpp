#include "nodes/particle_fluid/body_coupling.h"

#include "framework/compute/dispatch.h"

namespace weir {

template <class Backend>
void placeBodiesOn(Backend& device, WallField& walls, const Vec3f& gravity, double dt);

void placeBodies(WallField& walls, const Vec3f& gravity, double dt) {
  dispatch(walls.views.device(), [&](auto& device) { placeBodiesOn(device, walls, gravity, dt); });
}

}  // namespace weir
