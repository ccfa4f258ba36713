#include "nodes/particle_fluid/modules/drag.h"

#include <numbers>

namespace weir {

namespace {

struct Slow {
  const int* neighborCounts;
  float rate;        // dt·k of an exposed particle, s/m
  float inverseMax;  // 1 over the neighbours from which a particle is not exposed; 0 exposes all
  float kept;        // by damping
  Vec3f wind;
  ArrayView<Vec3f> velocities;

  WEIR_HD void operator()(std::int64_t i) const {
    const float exposed = 1 - static_cast<float>(neighborCounts[i]) * inverseMax;
    Vec3f v = velocities[i];
    if (exposed > 0) {
      const Vec3f relative = v - wind;
      v = wind + relative / (1 + exposed * rate * length(relative));
    }
    velocities[i] = kept * v;
  }
};

/// ½·ρ_air·C·A/(ρ0·V0), 1/m.
double dragPerLength(const FluidConstants& fluid, double airDensity, double coefficient) {
  constexpr double kPi = std::numbers::pi;
  const double volume = fluid.particleVolume;
  const double crossSection = kPi * std::pow(3 * volume / (4 * kPi), 2.0 / 3);
  return 0.5 * airDensity * coefficient * crossSection / (fluid.restDensity * volume);
}

}  // namespace

template <class Backend>
void Drag::stepOn(Backend& device, FluidStep& fluid) {
  const FluidConstants& c = fluid.constants;
  const double ratio = c.supportRadius / c.spacing;
  const double halfOfSettled = 2.0 / 3 * std::numbers::pi * ratio * ratio * ratio;
  const double dt = fluid.time.dt;
  parallelFor(device, "drag", fluid.particles.count(),
              Slow{fluid.neighbors.view().counts,
                   static_cast<float>(dt * dragPerLength(c, airDensity, dragCoefficient)),
                   on == DragOn::kAll ? 0.0f : static_cast<float>(1 / halfOfSettled),
                   static_cast<float>(std::exp(-dt * damping)), wind, fluid.particles.velocities().write()});
}

template void Drag::stepOn(ThisBackend&, FluidStep&);

}  // namespace weir
