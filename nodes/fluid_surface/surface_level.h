// What makes surfaces enclose the volume of their particles: the value of the field at the surface, and the
// size of lone particles.
#pragma once

#include "framework/base/api.h"
#include "nodes/fluid_surface/particle_kernels.h"

namespace WEIR_API weir {

/// The mean of the field over a plane half a spacing above the outermost layer of particles that lie on a
/// cubic lattice below it. Smoothed centres stand further inside than their particles, so this is less than
/// 1/2. Made from the kernels that `settings` give such particles; waits for the device.
float flatLevel(Device& device, const KernelSettings& settings);

/// a_0 such that the field of a lone particle is above `level` in a ball of volume d³. With
/// k = (level·h³/(W(0)·d³))^⅓ the ball's radius is a_0·h·√(1 − k·a_0). Where no a_0 up to 1 makes it as
/// large, the one that comes nearest.
float loneAxis(float level, const KernelSettings& settings);

}  // namespace weir
