#include "nodes/particle_fluid/fluid_statistics.h"

#include "framework/compute/parallel.h"
#include "framework/particles/rank_sums.h"

namespace weir {

namespace {

WEIR_HD Vec3d toDouble(const Vec3f& v) {
  return {v.x, v.y, v.z};
}

/// Whichever is larger; of a number and something that is none, the number.
WEIR_HD double largest(double known, double other) {
  return other > known ? other : known;
}

struct SumsOfOne {
  ArrayView<const Vec3f> positions, velocities;
  ArrayView<const float> densities;
  ArrayView<const int> neighborCounts;
  double restDensity;

  WEIR_HD FluidSums operator()(std::int64_t i) const {
    const Vec3d v = toDouble(velocities[i]);
    const double speedSquared = dot(v, v), over = double(densities[i]) / restDensity - 1;
    const int neighbors = i < neighborCounts.size ? neighborCounts[i] : 0;
    FluidSums one{.velocity = v,
                  .position = toDouble(positions[i]),
                  .speedSquared = speedSquared,
                  .maxSpeedSquared = largest(0, speedSquared),
                  .compression = over < 0 ? 0 : over,
                  .maxCompression = largest(0, over),
                  .neighbors = neighbors,
                  .maxNeighbors = neighbors};
    one.box.extend(positions[i]);
    return one;
  }
};

struct MotionOfOne {
  ArrayView<const Vec3f> velocities;
  WEIR_HD MotionSums operator()(std::int64_t i) const {
    const Vec3d v = toDouble(velocities[i]);
    return {v, dot(v, v)};
  }
};

struct PlaceOfOne {
  ArrayView<const Vec3f> positions;
  ArrayView<const float> densities;
  double restDensity;
  WEIR_HD PlaceSums operator()(std::int64_t i) const {
    const double over = double(densities[i]) / restDensity - 1;
    return {toDouble(positions[i]), over < 0 ? 0 : over};
  }
};

struct AddSums {
  WEIR_HD FluidSums operator()(const FluidSums& a, const FluidSums& b) const {
    return {.velocity = a.velocity + b.velocity,
            .position = a.position + b.position,
            .speedSquared = a.speedSquared + b.speedSquared,
            .maxSpeedSquared = largest(a.maxSpeedSquared, b.maxSpeedSquared),
            .compression = a.compression + b.compression,
            .maxCompression = largest(a.maxCompression, b.maxCompression),
            .neighbors = a.neighbors + b.neighbors,
            .maxNeighbors = a.maxNeighbors > b.maxNeighbors ? a.maxNeighbors : b.maxNeighbors,
            .box = {min(a.box.lo, b.box.lo), max(a.box.hi, b.box.hi)}};
  }
};

}  // namespace

template <class Backend>
void sumFluid(Backend& device, const ParticleSet& particles, ArrayView<const int> neighborCounts,
              double restDensity, FluidSums* sums) {
  reduce(device, "statistics", particles.count(), FluidSums{},
         SumsOfOne{particles.positions().read(), particles.velocities().read(),
                   particles.get<float>("density").read(), neighborCounts, restDensity},
         AddSums{}, sums);
}

template <class Backend>
void sumExactly(Backend& device, Communicator& ranks, const ParticleSet& particles, double restDensity,
                MotionSums* motion, PlaceSums* place) {
  const OnAllRanks all{&ranks, particles.count()};
  sumOverRanks(device, "statistics", all, MotionOfOne{particles.velocities().read()}, Plus{}, motion);
  sumOverRanks(device, "statistics", all,
               PlaceOfOne{particles.positions().read(), particles.get<float>("density").read(), restDensity},
               Plus{}, place);
}

template void sumFluid(ThisBackend&, const ParticleSet&, ArrayView<const int>, double, FluidSums*);
template void sumExactly(ThisBackend&, Communicator&, const ParticleSet&, double, MotionSums*, PlaceSums*);

}  // namespace weir
