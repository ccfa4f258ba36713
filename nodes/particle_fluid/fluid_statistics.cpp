#include "nodes/particle_fluid/fluid_statistics.h"

#include <algorithm>
#include <cmath>

namespace weir {

namespace {

Value toValue(const Vec3d& v) {
  return Value::Array{v.x, v.y, v.z};
}

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
  const std::vector<Vec3f> positions = particles.positions().toHost(n);
  const std::vector<Vec3f> velocities = particles.velocities().toHost(n);
  const std::vector<float> densities = particles.get<float>("density").toHost(n);
  const std::vector<int> neighborCounts = neighbors.countsOnHost(n);

  Vec3d momentum{}, center{};
  double kinetic = 0, speedSquared = 0, compression = 0, mostCompression = 0, neighborSum = 0;
  Aabb bounds;
  int mostNeighbors = 0;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const Vec3d v = toDouble(velocities[i]);
    momentum += v;
    center += toDouble(positions[i]);
    kinetic += 0.5 * dot(v, v);
    speedSquared = std::max(speedSquared, dot(v, v));
    const double over = std::max(double(densities[i]) / constants.restDensity - 1, 0.0);
    compression += over;
    mostCompression = std::max(mostCompression, over);
    neighborSum += neighborCounts[i];
    mostNeighbors = std::max(mostNeighbors, neighborCounts[i]);
    bounds.extend(positions[i]);
  }
  const double mass = constants.particleMass, count = std::max(double(n), 1.0);
  const double potential = -mass * dot(toDouble(gravity), center);
  statistics["particles"] = n;
  statistics["fluid_volume"] = double(n) * constants.particleVolume;
  statistics["neighbors"] = meanAndMax(neighborSum / count, mostNeighbors);
  statistics["compression"] = meanAndMax(compression / count, mostCompression);
  statistics["linear_momentum"] = toValue(mass * momentum);
  statistics["kinetic_energy"] = mass * kinetic;
  statistics["potential_energy"] = potential;
  statistics["max_speed"] = std::sqrt(speedSquared);
  if (n == 0) return;
  statistics["center_of_mass"] = toValue(center / count);
  statistics["bounds"] = Value::Array{toValue(toDouble(bounds.lo)), toValue(toDouble(bounds.hi))};
}

}  // namespace weir
