#include "nodes/particle_fluid/fluid_statistics.h"

#include <algorithm>
#include <cmath>

#include "framework/base/vec_value.h"

namespace weir {

namespace {

Vec3d toDouble(const Vec3f& v) {
  return {v.x, v.y, v.z};
}

Value meanAndMax(double mean, double max) {
  Value v = Value::object();
  v["mean"] = mean;
  v["max"] = max;
  return v;
}

}  // namespace

void writeFluidStatistics(const ParticleSet& particles, const NeighborList& neighbors,
                          const FluidConstants& constants, const Vec3f& gravity, Value& statistics) {
  const std::int64_t n = particles.bound();
  FluidSums sums;
  if (n > 0) {
    Array<FluidSums> onDevice(particles.device(), 1);
    dispatch(particles.device(), [&](auto& device) {
      sumFluid(device, particles, neighbors.counts(), constants.restDensity, onDevice.data());
    });
    sums = onDevice.toHost().front();
  }
  const double mass = constants.particleMass, count = std::max(double(n), 1.0);
  statistics["particles"] = n;
  statistics["fluid_volume"] = double(n) * constants.particleVolume;
  statistics["neighbors"] = meanAndMax(double(sums.neighbors) / count, sums.maxNeighbors);
  statistics["compression"] = meanAndMax(sums.compression / count, sums.maxCompression);
  statistics["linear_momentum"] = toValue(mass * sums.velocity);
  statistics["kinetic_energy"] = mass * 0.5 * sums.speedSquared;
  statistics["potential_energy"] = -mass * dot(toDouble(gravity), sums.position);
  statistics["max_speed"] = std::sqrt(sums.maxSpeedSquared);
  if (n == 0) return;
  statistics["center_of_mass"] = toValue(sums.position / count);
  statistics["bounds"] = Value::Array{toValue(toDouble(sums.box.lo)), toValue(toDouble(sums.box.hi))};
}

}  // namespace weir
