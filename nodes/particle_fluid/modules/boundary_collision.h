// Keeps particles out of solids that are given by signed distance.
//
// A particle closer to a solid than r, the fluid's `contact` (φ < r), is put to φ = r along the normal. The
// velocity it has into the wall is reflected with the wall's restitution e, and Coulomb friction takes at
// most μ times that change of velocity from the tangential part:
//
//   Δv_n = −(1 + e)·v_n  (if v_n < 0)        v_t ← v_t·max(0, 1 − μ·|Δv_n|/|v_t|)
//
// Both are laws of impulses, so the effect over time does not depend on dt.
#pragma once

#include "nodes/particle_fluid/fluid_module.h"

namespace weir {

class BoundaryCollision final : public FluidModule {
 public:
  static constexpr ModuleInfo kInfo{
      "BoundaryCollision", kFamily,
      "Pushes particles out of boundaries, with their restitution and friction.",
      "wall, collider, bounce, friction"};
  const ModuleInfo& info() const override { return kInfo; }

  void step(FluidStep& fluid) override {
    if (!fluid.boundaries.empty()) dispatch(fluid.device, [&](auto& device) { stepOn(device, fluid); });
  }

 private:
  template <class Backend>
  void stepOn(Backend& device, FluidStep& fluid);
};

}  // namespace weir
