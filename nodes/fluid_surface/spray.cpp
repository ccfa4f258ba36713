#include "nodes/fluid_surface/spray.h"

#include <cmath>
#include <numbers>

#include "framework/compute/dispatch.h"

namespace weir {

bool breaksUp(float spacing) {
  constexpr double kLargestDrop = 0.006;  // m across
  return std::pow(double(spacing), 3) > std::numbers::pi / 6 * std::pow(kLargestDrop, 3);
}

float Spray::meanRadius() {
  // The mean of r³ is 5/4 of that of r, cubed.
  constexpr double kPerDrop = 4 * std::numbers::pi / 3 * 5 / 4;
  return static_cast<float>(std::cbrt(1 / (kDrops * kPerDrop)));
}

void Spray::make(Device& onDevice, const ParticleKernels& kernels, const ParticleSet& particles,
                 float spacing) {
  int kept = 0;
  if (kernels.size() > 0) {
    chosen_.resizeDiscarding(kernels.size());
    dispatch(onDevice, [&](auto& device) { chooseOn(device, kernels.spray()); });
    kept = kept_.toHost().front();
  }
  const std::int64_t drops = std::int64_t{kDrops} * kept;
  positions_.resizeDiscarding(drops), velocities_.resizeDiscarding(drops), radii_.resizeDiscarding(drops);
  if (drops > 0) dispatch(onDevice, [&](auto& device) { placeOn(device, kernels, particles, spacing); });
}

}  // namespace weir
