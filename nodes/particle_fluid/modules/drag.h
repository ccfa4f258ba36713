// Drag of the air, and plain damping.
//
//   v_i − w ← (v_i − w) / (1 + dt·k_i·|v_i − w|),   k_i = e_i·½·ρ_air·C·A/(ρ0·V0),   A = π·(3·V0/4π)^(2/3)
//   v_i ← v_i·exp(−dt·damping)
//
// The first is the exact solution of dv/dt = −k·|v − w|·(v − w), the drag of a ball of the particle's volume
// in wind w, so it is stable for any dt, as is the second. e_i is how far the particle is exposed: 1 without
// neighbours, falling linearly to 0 at half the number of neighbours of settled fluid, ⅔π·(H/d)³. So spray
// and splashes feel the air, a calm surface and the inside do not; "on": "all" sets e_i = 1.
#pragma once

#include "framework/communication/on_ranks.h"
#include "framework/compute/dispatch.h"
#include "nodes/particle_fluid/fluid_module.h"

namespace weir {

enum class DragOn { kExposed, kAll };
template <>
struct EnumNames<DragOn> {
  static constexpr std::array<EnumName, 2> kNames{
      EnumName{"exposed",
               "Spray and splashes: fully without neighbours, not at all from half of the usual number."},
      EnumName{"all", "Every particle as if it were alone."}};
};

class Drag final : public FluidModule, public OnRanks {
 public:
  static constexpr ModuleInfo kInfo{
      "Drag", kFamily,
      "Slows spray by the drag of the air, or all by damping; insert it after \"viscosity\".",
      "air, damping, slow, resistance, wind"};
  const ModuleInfo& info() const override { return kInfo; }

  Param<DragOn> on{*this, "on", DragOn::kExposed, {.live = true, .doc = "Which particles the air drags."}};
  Param<float> airDensity{*this,
                          "air_density",
                          1.2f,
                          {.unit = "kg/m^3",
                           .min = 0,
                           .softMax = 1000,
                           .live = true,
                           .doc = "Density of the air, or whatever surrounds the fluid; 0 is a vacuum."}};
  Param<float> dragCoefficient{
      *this,
      "drag_coefficient",
      0.47f,
      {.min = 0,
       .softMax = 2,
       .live = true,
       .doc = "Drag over dynamic pressure and cross-section; that of a smooth ball."}};
  Param<Vec3f> wind{*this, "wind", {}, {.unit = "m/s", .live = true, .doc = "Velocity of the air."}};
  Param<float> damping{*this,
                       "damping",
                       0,
                       {.unit = "1/s",
                        .min = 0,
                        .softMax = 10,
                        .live = true,
                        .doc = "Rate at which the velocities of all particles decay, wind or not."}};

  void step(FluidStep& fluid) override {
    dispatch(fluid.device, [&](auto& device) { stepOn(device, fluid); });
  }

 private:
  template <class Backend>
  void stepOn(Backend& device, FluidStep& fluid);
};

}  // namespace weir
