#include "nodes/particle_fluid/modules/xsph.h"

#include "framework/compute/dispatch.h"
#include "framework/neighbors/motion_code.h"

namespace weir {

void Xsph::reset(FluidStep& fluid) {
  if (form == XsphForm::kExplicit) fluid.particles.byProducts().request(kMotionCodes);
}

void Xsph::step(FluidStep& fluid) {
  if (form == XsphForm::kExplicit) {
    if (strength > 0) dispatch(fluid.device, [&](auto& device) { stepOn(device, fluid); });
  } else if (viscosity > 0) {
    dispatch(fluid.device, [&](auto& device) { implicitOn(device, fluid); });
  }
}

double Xsph::memory(const FluidRoom& room) const {
  return form == XsphForm::kExplicit ? 0 : bytesOfArrays(room.particles, next_);
}

}  // namespace weir
