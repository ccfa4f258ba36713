// Numbers that say how a fluid is doing, summed in double precision on its device.
#pragma once

#include <cstdint>

#include "framework/base/api.h"
#include "framework/base/value.h"
#include "framework/communication/communicator.h"
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

/// The same, on the host; waits for the device.
FluidSums sumsOfFluid(const ParticleSet& particles, const NeighborList& neighbors,
                      const FluidConstants& constants);

/// The same over the particles of all ranks, which ask together. Sums are exact (rank_sums.h): the same bits
/// for any number of ranks. In them, what is NaN counts as 0.
FluidSums sumsOfFluid(Communicator& ranks, const ParticleSet& particles, const NeighborList& neighbors,
                      const FluidConstants& constants);

/// Adds to `statistics`, of n particles: particles, fluid_volume [m³] (particles times spacing cubed),
/// neighbors {mean, max}, compression {mean, max} of max(λ − 1, 0), linear_momentum [kg·m/s], kinetic_energy
/// [J], potential_energy [J] (relative to the origin), center_of_mass [m], bounds [m], max_speed [m/s].
void writeFluidStatistics(std::int64_t n, const FluidSums& sums, const FluidConstants& constants,
                          const Vec3f& gravity, Value& statistics);

/// Sums that ranks add exactly, in two parts, as blocks of a GPU have no room for all at once.
struct MotionSums {
  Vec3d velocity;
  double speedSquared = 0;
  friend WEIR_HD MotionSums operator+(const MotionSums& a, const MotionSums& b) {
    return {a.velocity + b.velocity, a.speedSquared + b.speedSquared};
  }
};
struct PlaceSums {
  Vec3d position;
  double compression = 0;
  friend WEIR_HD PlaceSums operator+(const PlaceSums& a, const PlaceSums& b) {
    return {a.position + b.position, a.compression + b.compression};
  }
};
/// Writes them to the device.
template <class Backend>
void sumExactly(Backend& device, Communicator& ranks, const ParticleSet& particles, double restDensity,
                MotionSums* motion, PlaceSums* place);

}  // namespace weir
