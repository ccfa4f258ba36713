#include "nodes/particle_fluid/rest_state.h"

#include <algorithm>
#include <cmath>

namespace weir {

RestState::RestState(FluidStep& fluid, std::vector<const ParticleBatch*> batches)
    : fluid_(fluid), batches_(std::move(batches)), sum_(fluid.device, 1) {}

bool RestState::wanted() const {
  return std::any_of(batches_.begin(), batches_.end(), [](const ParticleBatch* b) { return b->container != nullptr; });
}

int RestState::reach(int most, const std::function<void()>& step) {
  constexpr float kKept = 0.9f;  // of the velocities in a step
  constexpr int kBetweenLooks = 16;
  // At rest: falling freely, particles would be as fast after a hundredth of a spacing.
  const double atRest = 1e-4 * 0.5 * length(fluid_.time.gravity) * fluid_.constants.spacing;
  int taken = 0;
  while (taken < most) {
    dispatch(fluid_.device, [&](auto& device) { dampOn(device, kKept); });
    step();
    dispatch(fluid_.device, [&](auto& device) { containOn(device); });
    ++taken;
    if (taken % kBetweenLooks != 0) continue;
    double square = 0;
    dispatch(fluid_.device, [&](auto& device) { square = meanSquareSpeedOn(device); });
    if (getenv("REST")) printf("rest %d v2 %g\n", taken, square);
    if (square <= atRest) break;
  }
  dispatch(fluid_.device, [&](auto& device) { releaseOn(device); });
  return taken;
}

}  // namespace weir
