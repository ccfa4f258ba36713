#include "nodes/particle_fluid/rest_state.h"

#include <algorithm>
#include <cmath>

namespace weir {

RestState::RestState(FluidStep& fluid, std::vector<const ParticleBatch*> batches)
    : fluid_(fluid), batches_(std::move(batches)), sum_(fluid.device, 1) {}

bool RestState::wanted() const {
  return std::any_of(batches_.begin(), batches_.end(),
                     [](const ParticleBatch* b) { return b->container != nullptr; });
}

int RestState::reach(int most, const std::function<void()>& step) {
  // At rest: a particle that falls freely has this speed after half a thousandth of a spacing.
  const double atRest = 1e-3 * length(fluid_.time.gravity) * fluid_.constants.spacing;
  double last = 0;
  int taken = 0;
  bool moving = true;
  while (taken < most && moving) {
    step();
    dispatch(fluid_.device, [&](auto& device) { containOn(device); });
    ++taken;
    double square = 0;
    dispatch(fluid_.device, [&](auto& device) { square = meanSquareSpeedOn(device); });
    // Motion is stopped where it is fastest, which is where the forces vanish.
    const bool fastest = square <= last;
    moving = !(fastest && square <= atRest);
    dispatch(fluid_.device, [&](auto& device) { dampOn(device, fastest ? 0.0f : 1.0f); });
    last = fastest ? 0 : square;
  }
  dispatch(fluid_.device, [&](auto& device) { releaseOn(device); });
  return taken;
}

}  // namespace weir
