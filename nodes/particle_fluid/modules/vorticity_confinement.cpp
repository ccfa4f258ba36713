#include "nodes/particle_fluid/modules/vorticity_confinement.h"

namespace weir {

void VorticityConfinement::reset(FluidStep& fluid) {
  vorticity_ = fluid.particles.add<Vec3f>(
      {"vorticity", AttributeType::kVec3, "1/s", "Curl of the velocity, twice the spin."});
}

}  // namespace weir
