// What is known to go wrong with a fluid as it is set up.
#pragma once

#include "framework/graph/node.h"
#include "nodes/particle_fluid/fluid_module.h"

namespace weir {

/// The fluid that is there at first.
struct InitialFluid {
  Aabb box;          ///< of its particles; empty if there are none
  double speed = 0;  ///< largest, m/s
};

/// ρ0·|g|·h with the extent h of the fluid along g, in Pa; 0 without fluid or gravity.
double hydrostaticPressure(const InitialFluid& fluid, const Vec3f& gravity, double restDensity);

/// Warns of: gravity or a first speed that carries particles too far in a step, where steps are equal; a
/// fluid that its own weight compresses noticeably, or by so little that rounding hides it, if its solver has
/// a bulk modulus.
void warnOfFluid(const FluidOutlook& outlook, const InitialFluid& fluid, const SetupContext& context,
                 bool hasModulus);

}  // namespace weir
