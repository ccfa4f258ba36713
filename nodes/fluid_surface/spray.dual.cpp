#include "nodes/fluid_surface/spray.h"
#include "framework/base/random.h"
#include "framework/compute/reductions.h"

namespace weir {

namespace {

struct IsSpray {
  ArrayView<const float> spray;
  WEIR_HD bool operator()(std::int64_t i) const { return spray[i] > 0; }
};

struct PlaceDrop {
  ArrayView<const int> chosen, particles;
  ArrayView<const float> spray;
  ArrayView<const Vec3f> positions, velocities;
  ArrayView<const std::int64_t> ids;
  float spacing, radius;  // m
  ArrayView<Vec3f> dropPositions, dropVelocities;
  ArrayView<float> radii;

  WEIR_HD void operator()(std::int64_t drop) const {
    const int kernel = chosen[drop / Spray::kDrops], i = particles[kernel];
    const std::uint64_t seed =
        splitMix64(static_cast<std::uint64_t>(ids[i]), static_cast<std::uint64_t>(drop % Spray::kDrops));
    const float share = spray[kernel], speed = length(velocities[i]);
    const float lag = speed * Spray::kLag > 3 * spacing ? 3 * spacing / speed : Spray::kLag;
    dropPositions[drop] = positions[i] + 0.5f * (1 + share) * spacing * around(seed) +
                          lag * static_cast<float>(noise(seed, 9)) * velocities[i];
    dropVelocities[drop] = velocities[i];
    radii[drop] = cbrtf(share) * radius * static_cast<float>(1 + noise(seed, 10) / 2);
  }

  /// Along each axis the sum of three even numbers: nearly normal, with a deviation of 1 and none beyond 3.
  WEIR_HD static Vec3f around(std::uint64_t seed) {
    const auto along = [seed](std::uint64_t axis) {
      const std::uint64_t first = 3 * axis;
      return static_cast<float>(noise(seed, first) + noise(seed, first + 1) + noise(seed, first + 2));
    };
    return {along(0), along(1), along(2)};
  }
};

}  // namespace

template <class Backend>
void Spray::chooseOn(Backend& device, ArrayView<const float> spray) {
  compact(device, "spray", spray.size, IsSpray{spray}, chosen_.view(), kept_.data());
}

template <class Backend>
void Spray::placeOn(Backend& device, const ParticleKernels& kernels, const ParticleSet& particles,
                    float spacing) {
  parallelFor(
      device, "spray drops", positions_.size(),
      PlaceDrop{std::as_const(chosen_).view(), kernels.particles(), kernels.spray(),
                particles.positions().read(), particles.velocities().read(), particles.ids().read(), spacing,
                meanRadius() * spacing, positions_.view(), velocities_.view(), radii_.view()});
}

template void Spray::chooseOn(ThisBackend&, ArrayView<const float>);
template void Spray::placeOn(ThisBackend&, const ParticleKernels&, const ParticleSet&, float);

}  // namespace weir
