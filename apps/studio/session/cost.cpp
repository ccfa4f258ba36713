#include "apps/studio/session/cost.h"

#include "framework/base/log.h"
#include "framework/run/simulation.h"

namespace weir::studio {

namespace {

bool fits(const MemoryEstimate& estimate, double available, const Device& device) {
  try {
    (void)estimate.check(available, device.name());
    return true;
  } catch (const Error&) {
    return false;
  }
}

}  // namespace

Value costOf(std::unique_ptr<Scene> scene, Device& device, const Registry& registry) {
  Log silent;
  Simulation simulation(std::move(scene), device, silent, registry);
  const MemoryEstimate estimate = simulation.estimate();
  const MemoryNeeds total = estimate.total();
  // A reset gives back first what the present run holds.
  const double free = static_cast<double>(device.availableMemory());
  const double available = free > 0 ? free + static_cast<double>(device.memoryUse().reserved) : 0;
  Value v = Value::object();
  v["particles"] = total.particles;
  v["bytes"] = total.device;
  v["available"] = available;
  // Steps that vary are no longer than those of the clock, and end at the same frames.
  v["steps"] = simulation.clock().totalSteps();
  v["at_least"] = simulation.stepsVary();
  v["fits"] = fits(estimate, available, device);
  return v;
}

}  // namespace weir::studio
