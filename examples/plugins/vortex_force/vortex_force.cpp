#include "vortex_force.h"

namespace vortex_force {

void VortexForce::validate() const {
  if (!(length(axis.get()) > 0)) throw sceneError("the axis is 0", "a direction").inParameter(axis.name());
}

void VortexForce::reset(FluidStep& fluid) {
  swirl_ =
      fluid.particles.add<Vec3f>({"swirl", AttributeType::kVec3, "m/s^2", "Acceleration by the vortex."});
}

}  // namespace vortex_force
