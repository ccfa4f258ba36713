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
  float spread, radius;  // m
  ArrayView<Vec3f> dropPositions, dropVelocities;
  ArrayView<float> radii;

  WEIR_HD void operator()(std::int64_t drop) const {
    const int kernel = chosen[drop / Spray::kDrops], i = particles[kernel];
    const std::uint64_t seed =
        splitMix64(static_cast<std::uint64_t>(ids[i]), static_cast<std::uint64_t>(drop % Spray::kDrops));
    dropPositions[drop] = positions[i] + spread * inBall(seed);
    dropVelocities[drop] = velocities[i];
    radii[drop] = cbrtf(spray[kernel]) * radius * static_cast<float>(1 + noise(seed, 4) / 3);
  }

  /// Even in all directions and in the distance, so that most are near the middle.
  WEIR_HD static Vec3f inBall(std::uint64_t seed) {
    constexpr float kPi = 3.14159265358979f;
    const auto up = static_cast<float>(noise(seed, 0)), angle = kPi * static_cast<float>(noise(seed, 1));
    const float away = 0.5f + 0.5f * static_cast<float>(noise(seed, 2)), across = sqrtf(1 - up * up);
    return away * Vec3f{across * cosf(angle), up, across * sinf(angle)};
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
  constexpr float kSpread = 1.25f;  // half of how far apart the particles of the thinnest cloud are
  parallelFor(device, "spray drops", positions_.size(),
              PlaceDrop{std::as_const(chosen_).view(), kernels.particles(), kernels.spray(),
                        particles.positions().read(), particles.velocities().read(), particles.ids().read(),
                        kSpread * spacing, meanRadius() * spacing, positions_.view(), velocities_.view(),
                        radii_.view()});
}

template void Spray::chooseOn(ThisBackend&, ArrayView<const float>);
template void Spray::placeOn(ThisBackend&, const ParticleKernels&, const ParticleSet&, float);

}  // namespace weir
