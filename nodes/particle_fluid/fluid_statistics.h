// Numbers that say how a fluid is doing, summed in double precision on the host.
#pragma once

#include "framework/base/value.h"
#include "nodes/particle_fluid/fluid_constants.h"
#include "nodes/particles/neighbor_list.h"
#include "nodes/particles/particle_set.h"

namespace weir {

/// Adds to `statistics`: particles, fluid_volume [m³] (particles times spacing cubed), neighbors {mean, max},
/// compression {mean, max} of max(λ − 1, 0), linear_momentum [kg·m/s], kinetic_energy [J], potential_energy
/// [J] (relative to the origin), center_of_mass [m], bounds [m], max_speed [m/s]. Expects neighbours and the
/// attribute "density" as of the last frame. Waits for the device.
void writeFluidStatistics(const ParticleSet& particles, const NeighborList& neighbors,
                          const FluidConstants& constants, const Vec3f& gravity, Value& statistics);

}  // namespace weir
