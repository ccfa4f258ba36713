#include "nodes/particle_fluid/body_coupling.h"

namespace weir {

template <class Backend>
void placeBodiesOn(Backend& device, Array<SolidView>& views, const Vec3f& gravity, double dt);

void placeBodies(Array<SolidView>& views, const Vec3f& gravity, double dt) {
  dispatch(views.device(), [&](auto& device) { placeBodiesOn(device, views, gravity, dt); });
}

}  // namespace weir
