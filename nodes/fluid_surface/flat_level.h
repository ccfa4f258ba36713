// The value of the field at which the surface of a flat, deep fluid is where it should be.
#pragma once

#include "nodes/fluid_surface/particle_kernels.h"

namespace weir {

/// The mean of the field over a plane half a spacing above the outermost layer of particles that lie on a
/// cubic lattice below it. Smoothed centres stand further inside than their particles, so this is less than
/// 1/2. Made from the kernels that `settings` give such particles; waits for the device.
float flatLevel(Device& device, const KernelSettings& settings);

}  // namespace weir
