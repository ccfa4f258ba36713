// Sums over the particles in a box, in double precision.
#pragma once

#include <cstdint>

#include "nodes/gauge/particle_matter.h"

namespace weir {

struct BoxSums {
  std::int64_t particles = 0;
  double volume = 0;         ///< m³
  double mass = 0;           ///< kg
  Vec3d momentum;            ///< kg·m/s
  double kineticEnergy = 0;  ///< J
  double density = 0;        ///< kg/m³, times volume
  double pressure = 0;       ///< Pa, times volume
};

/// Writes them to *sums, on the device.
template <class Backend>
void sumBox(Backend& device, const Particles& particles, const Aabb& box, BoxSums* sums);

}  // namespace weir
