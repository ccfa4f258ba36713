// v* = v + dt·g,  x* = x + dt·v*  (paper, Algorithm 1, first loop).
#pragma once

#include "framework/communication/on_ranks.h"
#include "nodes/particle_fluid/fluid_module.h"

namespace weir {

class Predict final : public FluidModule, public OnRanks {
 public:
  static constexpr ModuleInfo kInfo{"Predict", kFamily,
                                    "Moves particles by their velocity and gravity alone.",
                                    "gravity, advection, integrate"};
  const ModuleInfo& info() const override { return kInfo; }

  void step(FluidStep& fluid) override {
    fluid.particles.move({fluid.time.gravity, static_cast<float>(fluid.time.dt)});
  }
};

}  // namespace weir
