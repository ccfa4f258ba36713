// Stops particles at rigid meshes on their way to their predicted positions, so that the solver starts from
// places on the right side of every wall; and lets them bounce off boundaries, before pressure slows them.
//
// In the frame of a solid, a particle goes from where it is at the beginning of the step to where it is
// predicted at its end. Both ends are exact; the way between them is taken to be straight, which may cut a
// corner of a turning solid, but never changes on which side of its surface the particle ends.
#pragma once

#include "framework/communication/on_ranks.h"
#include "framework/compute/dispatch.h"
#include "nodes/particle_fluid/fluid_module.h"
#include "nodes/particle_fluid/wall_field.h"

namespace weir {

class SolidApproach final : public FluidModule, public OnRanks {
 public:
  static constexpr ModuleInfo kInfo{
      "SolidApproach", kFamily,
      "Stops particles at solids on their way to their predicted positions (continuous collision).",
      "collider, tunnelling, ccd, collision"};
  const ModuleInfo& info() const override { return kInfo; }

  void step(FluidStep& fluid) override {
    if (fluid.walls.bounces) dispatch(fluid.device, [&](auto& device) { bounceOn(device, fluid); });
    if (fluid.walls.empty()) return;
    fluid.walls.place(fluid.time.time, fluid.time.dt, fluid.time.gravity);
    dispatch(fluid.device, [&](auto& device) { stepOn(device, fluid); });
  }

 private:
  template <class Backend>
  void bounceOn(Backend& device, FluidStep& fluid);
  template <class Backend>
  void stepOn(Backend& device, FluidStep& fluid);
};

}  // namespace weir
