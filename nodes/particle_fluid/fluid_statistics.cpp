#include "nodes/particle_fluid/fluid_statistics.h"

#include <algorithm>
#include <cmath>

#include "framework/base/vec_value.h"
#include "framework/compute/dispatch.h"

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

FluidSums sumsOfFluid(const ParticleSet& particles, const NeighborList& neighbors,
                      const FluidConstants& constants) {
  if (particles.bound() == 0) return {};
  Array<FluidSums> onDevice(particles.device(), 1);
  dispatch(particles.device(), [&](auto& device) {
    sumFluid(device, particles, neighbors.counts(), constants.restDensity, onDevice.data());
  });
  return onDevice.toHost().front();
}

FluidSums sumsOfFluid(Communicator& ranks, const ParticleSet& particles, const NeighborList& neighbors,
                      const FluidConstants& constants) {
  Array<MotionSums> motion(particles.device(), 1);
  Array<PlaceSums> place(particles.device(), 1);
  dispatch(particles.device(), [&](auto& device) {
    sumExactly(device, ranks, particles, constants.restDensity, motion.data(), place.data());
  });
  const MotionSums moving = motion.toHost().front();
  const PlaceSums standing = place.toHost().front();
  FluidSums all{.velocity = moving.velocity,
                .position = standing.position,
                .speedSquared = moving.speedSquared,
                .compression = standing.compression};
  for (const FluidSums& one : ranks.allGather(sumsOfFluid(particles, neighbors, constants))) {
    all.maxSpeedSquared = std::max(all.maxSpeedSquared, one.maxSpeedSquared);
    all.maxCompression = std::max(all.maxCompression, one.maxCompression);
    all.neighbors += one.neighbors;
    all.maxNeighbors = std::max(all.maxNeighbors, one.maxNeighbors);
    all.box.extend(one.box);
  }
  return all;
}

void writeFluidStatistics(std::int64_t n, const FluidSums& sums, const FluidConstants& constants,
                          const Vec3f& gravity, Value& statistics) {
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
