// What a particle is made of and does, as gauges see it.
#pragma once

#include "framework/base/vec.h"
#include "framework/compute/array.h"
#include "framework/particles/particles.h"

namespace weir {

/// A field of the material, or an attribute that there may not be.
struct ScalarField {
  ArrayView<const float> each;  // empty where all have the same
  float ofAll = 0;
  WEIR_HD float operator[](std::int64_t i) const { return each.size > 0 ? each[i] : ofAll; }
};

/// One particle.
struct ParticleMatter {
  Vec3f position, velocity;
  float volume = 0;       ///< m³
  float restDensity = 0;  ///< kg/m³, of the matter at rest
  float density = 0;      ///< kg/m³, as it is compressed
  float pressure = 0;     ///< Pa
};

/// All of them. Which of the attributes `density` and `pressure` there are is for the host to ask.
struct MatterView {
  ArrayView<const Vec3f> positions, velocities;
  ScalarField volumes, restDensities, densities, pressures;

  WEIR_HD ParticleMatter operator[](std::int64_t i) const {
    return {positions[i], velocities[i], volumes[i], restDensities[i], densities[i], pressures[i]};
  }
};

/// Throws as Particles::ownValues does.
MatterView matterOf(const Particles& particles);
bool hasScalar(const Particles& particles, std::string_view attribute);

}  // namespace weir
