// The sums of rank_sums.h, over the particles of a fluid.
#pragma once

#include "framework/particles/divided_particles.h"
#include "framework/particles/rank_sums.h"
#include "nodes/particle_fluid/fluid_module.h"

namespace weir {

/// Null where one rank has all particles.
inline Communicator* ranksOf(const FluidStep& fluid) {
  return fluid.divided != nullptr ? &fluid.divided->ranks() : nullptr;
}

/// All particles.
inline OnAllRanks allOf(const FluidStep& fluid) {
  return {ranksOf(fluid), fluid.particles.count()};
}

/// How many particles all ranks have; they ask together.
inline Count countOfAll(FluidStep& fluid) {
  return fluid.divided != nullptr ? Count(fluid.divided->countOfAll()) : fluid.particles.count();
}

}  // namespace weir
