#include "nodes/particle_fluid/modules/pbf.h"

#include "nodes/particle_fluid/modules/pbf_passes.h"
#include "nodes/particle_fluid/scratch.h"

namespace weir {

template <class Backend>
void Pbf::stepOn(Backend& device, FluidStep& fluid) {
  fitScratch(fluid, state_, weighted_, displacement_);
  constexpr float kRepulsionDistance = 0.2f;    // support radii
  constexpr float kUnnormalizedEpsilon = 0.1f;  // 1/m⁸
  const Count count = fluid.particles.count();
  const FluidConstants& c = fluid.constants;
  const bool textbook = form == PbfForm::kTextbook;
  const float area = c.spacing * c.spacing;
  const auto positions = fluid.particles.positions().write().view();
  const WallFieldView walls = fluid.walls.view();
  const PairGradient gradient = pairGradientOf(c);
  const pbf::Multiplier multiplier{
      fluid.neighbors.view(),
      gradient,
      textbook ? epsilon / area : kUnnormalizedEpsilon * c.particleVolume * c.particleVolume,
      textbook ? 1.0f : stepFactor * c.particleMass,
      tension,
      walls,
      state_.view(),
      weighted_.view()};
  const pbf::Correct correct{fluid.neighbors.view(),
                             gradient,
                             textbook ? artificialPressure * area : 0.0f,
                             1 / c.kernel.value(kRepulsionDistance * c.supportRadius),
                             walls,
                             positions,
                             weighted_.view(),
                             displacement_.view(),
                             state_.view()};

  fluid.walls.forgetShares();
  parallelFor(device, "start", count, StartDisplacement{positions, state_.view(), displacement_.view()});
  if (recordObjective) objective_->begin(fluid, iterations + 1);
  fluid.exchange(state_.view());
  record(fluid);
  for (int k = 0; k < iterations; ++k) {
    parallelFor(device, "multipliers", count, multiplier);
    fluid.exchange(weighted_.view());
    parallelFor(device, "correct", count, correct);
    fluid.exchange(state_.view());
    record(fluid);
  }
  parallelFor(device, "finish", count,
              FinishDisplacement{1 / static_cast<float>(fluid.time.dt), displacement_.view(), positions,
                                 fluid.particles.velocities().write()});
}

template void Pbf::stepOn(ThisBackend&, FluidStep&);

}  // namespace weir
