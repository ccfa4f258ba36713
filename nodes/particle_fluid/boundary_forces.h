// What boundaries that report forces feel of a fluid: the impulses opposite to all that they do to its
// particles, each for the boundary that did it. Nothing is done where none reports.
#pragma once

#include "nodes/particle_fluid/fluid_module.h"
#include "nodes/particle_fluid/wall_field.h"

namespace weir {

/// Adds the pressure of a step, which solvers have left as the particles' shares: −m/dt·share·∇Φ of each.
template <class Backend>
void addPressureImpulses(Backend& device, FluidStep& fluid);

template <class Backend>
void keepVelocities(Backend& device, FluidStep& fluid);
template <class Backend>
void addChangesOfVelocity(Backend& device, FluidStep& fluid);

/// Calls contact(), and adds what it changes velocities by, each to the boundary that is nearest.
template <class Backend, class F>
void addContactImpulses(Backend& device, FluidStep& fluid, const F& contact) {
  if (!fluid.walls.reports()) return contact();
  keepVelocities(device, fluid);
  contact();
  addChangesOfVelocity(device, fluid);
}

}  // namespace weir
