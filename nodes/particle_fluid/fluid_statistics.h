// Numbers that say how a fluid is doing, summed in double precision on its device.
#pragma once

#include <cstdint>

#include "framework/base/api.h"
#include "framework/base/value.h"
#include "framework/neighbors/neighbor_list.h"
#include "framework/particles/particle_set.h"
#include "nodes/particle_fluid/fluid_constants.h"

namespace WEIR_API weir {

/// Sums and extremes over some particles; as it is, over none.
struct FluidSums {
  Vec3d velocity, position;
  double speedSquared = 0, maxSpeedSquared = 0;
  double compression = 0, maxCompression = 0;  ///< of max(λ − 1, 0)
  std::int64_t neighbors = 0, maxNeighbors = 0;
  Aabb box;
};

/// Writes those over all particles to *sums, on the device; its attribute "density" and the numbers of
/// neighbours are as of the last frame, and there may be none yet where a run failed before its first search.
/// Extremes leave out NaN.
template <class Backend>
WEIR_API void sumFluid(Backend& device, const ParticleSet& particles, ArrayView<const int> neighborCounts,
                       double restDensity, FluidSums* sums);

/// Adds to `statistics`: particles, fluid_volume [m³] (particles times spacing cubed), neighbors {mean, max},
/// compression {mean, max} of max(λ − 1, 0), linear_momentum [kg·m/s], kinetic_energy [J], potential_energy
/// [J] (relative to the origin), center_of_mass [m], bounds [m], max_speed [m/s]. Expects neighbours and the
/// attribute "density" as of the last frame, and the exact number of particles. Waits for the device.
void writeFluidStatistics(const ParticleSet& particles, const NeighborList& neighbors,
                          const FluidConstants& constants, const Vec3f& gravity, Value& statistics);

}  // namespace weir
