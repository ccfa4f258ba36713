// The last word of rigid meshes in a step: particles that the solver or other modules pushed at them are
// stopped, friction acts, and the solids are told what the fluid did to them.
//
// With Δv_n the change of a particle's velocity by a solid's pressure in this step, and v_t its velocity
// along the solid relative to it, Coulomb friction and the rate r of no-slip give
//
//   v_t ← v_t·max(0, 1 − μ·Δv_n/|v_t|)·exp(−r·dt·min(1, 2Φ/s))
//
// The factor of Φ is 1 for what touches a plane and 0 for what feels no solid.
#pragma once

#include "framework/base/api.h"
#include "framework/communication/on_ranks.h"
#include "framework/compute/dispatch.h"
#include "nodes/particle_fluid/fluid_module.h"
#include "nodes/particle_fluid/wall_field.h"

namespace WEIR_API weir {

class SolidContact final : public FluidModule, public OnRanks {
 public:
  static constexpr ModuleInfo kInfo{
      "SolidContact", kFamily,
      "Stops particles at solids, lets friction act, and sums the forces on the solids.",
      "collider, collision, friction, force"};
  const ModuleInfo& info() const override { return kInfo; }

  void step(FluidStep& fluid) override {
    if (fluid.walls.empty()) return;
    if (fluid.walls.moves && !fluid.walls.moved)
      throw sceneError("the fluid meets a RigidBody, but no solver of it moves bodies",
                       "a SemiImplicitSolver, an AcceleratedSolver or TwoProjections");
    dispatch(fluid.device, [&](auto& device) { stepOn(device, fluid); });
  }

 private:
  template <class Backend>
  void stepOn(Backend& device, FluidStep& fluid);
};

}  // namespace weir
