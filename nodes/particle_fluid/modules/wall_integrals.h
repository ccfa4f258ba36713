// Finds what each particle feels of rigid meshes: Φ, ∇Φ and D at its predicted position, see wall_field.h.
#pragma once

#include "framework/base/api.h"
#include "framework/communication/on_ranks.h"
#include "framework/compute/dispatch.h"
#include "nodes/particle_fluid/fluid_module.h"
#include "nodes/particle_fluid/wall_field.h"

namespace WEIR_API weir {

class WallIntegrals final : public FluidModule, public WallFinder, public OnRanks {
 public:
  static constexpr ModuleInfo kInfo{
      "WallIntegrals", kFamily,
      "Integrates the kernel over the solids near each particle, so that the solver feels them.",
      "wall, boundary"};
  const ModuleInfo& info() const override { return kInfo; }

  void step(FluidStep& fluid) override {
    if (!fluid.walls.empty()) findWalls(fluid);
  }
  void findWalls(FluidStep& fluid) override {
    dispatch(fluid.device, [&](auto& device) { findOn(device, fluid); });
  }

 private:
  template <class Backend>
  static void findOn(Backend& device, FluidStep& fluid);
};

}  // namespace weir
