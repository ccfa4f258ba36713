// What solids given by signed distance do beside holding the fluid by its pressure (wall_field.h): they rub
// on what pressure holds, and what comes nearer than the fluid's `contact` all the same is put back, with
// restitution and friction (boundary_contact.h).
#pragma once

#include "framework/communication/on_ranks.h"
#include "framework/compute/dispatch.h"
#include "nodes/particle_fluid/fluid_module.h"
#include "nodes/particle_fluid/wall_field.h"

namespace weir {

class BoundaryCollision final : public FluidModule, public OnRanks {
 public:
  static constexpr ModuleInfo kInfo{
      "BoundaryCollision", kFamily,
      "Pushes particles out of boundaries, with their restitution and friction.",
      "wall, collider, bounce, friction"};
  const ModuleInfo& info() const override { return kInfo; }

  void step(FluidStep& fluid) override {
    if (!fluid.walls.boundary.empty()) dispatch(fluid.device, [&](auto& device) { stepOn(device, fluid); });
  }

 private:
  template <class Backend>
  void stepOn(Backend& device, FluidStep& fluid);
  template <class Backend>
  void contactOn(Backend& device, FluidStep& fluid);
};

}  // namespace weir
