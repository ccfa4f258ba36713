// XSPH artificial viscosity in the form of Schechter and Bridson (2012):
//
//   v_i ← v_i + c·Σ_j V0·(v_j − v_i)·W(r_ij)
//
// Equal volumes make the exchange symmetric, so momentum is conserved. c has no unit; one sweep with c ≤ 1 is
// stable, because V0·ΣW ≤ λ.
#pragma once

#include "nodes/particle_fluid/fluid_module.h"

namespace weir {

class Xsph final : public FluidModule {
 public:
  static constexpr ModuleInfo kInfo{"Xsph", kFamily,
                                    "Smooths velocities between neighbours (artificial viscosity)."};
  const ModuleInfo& info() const override { return kInfo; }

  Param<float> strength{
      *this,
      "strength",
      0.3f,
      {.min = 0,
       .max = 1,
       .live = true,
       .animated = true,
       .doc = "Share of the difference to the neighbours' velocities that is removed in a step."}};

  void step(FluidStep& fluid) override {
    if (strength > 0) dispatch(fluid.device, [&](auto& device) { stepOn(device, fluid); });
  }

 private:
  template <class Backend>
  void stepOn(Backend& device, FluidStep& fluid);

  Array<Vec3f> smoothed_;
};

}  // namespace weir
