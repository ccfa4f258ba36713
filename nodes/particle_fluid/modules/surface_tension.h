// Surface tension by the gradient of a colour field, with air pressure, after He et al. (2014):
//
//   c_i  = Σ_j V0·W(r_ij)                     the particle itself included
//   ∇c_i = (1/c_i)·Σ_j V0·c_j·∇_i W(r_ij)
//   a_i  = (1/ρ0)·Σ_j V0·[ κ/4·(|∇c_i|² + |∇c_j|²) + p ]·∇_i W(r_ij)
//
// and v_i ← v_i + dt·a_i. With the rest volume V0 and the rest density ρ0 of an incompressible fluid in place
// of those that the particles show at a free surface, the force is equal and opposite within each pair, so
// linear momentum is conserved. κ belongs to an energy κ/2·|∇c|² per volume of the surface layer, so its unit
// is N; the same κ gives a tension in N/m that grows as 1/H. p presses on the surface alone: inside, ΣV0·∇W
// vanishes.
//
// W is the poly6 kernel. With the solver's own, attraction and pressure of a pair would cancel in any shape
// that has the right densities, and drops would stay cubes.
#pragma once

#include "framework/base/api.h"
#include "framework/communication/on_ranks.h"
#include "framework/compute/dispatch.h"
#include "nodes/particle_fluid/fluid_module.h"

namespace WEIR_API weir {

class SurfaceTension final : public FluidModule, public OnRanks {
 public:
  static constexpr ModuleInfo kInfo{
      "SurfaceTension", kFamily,
      "Draws the fluid's surface together; insert it after the module \"viscosity\".",
      "drops, cohesion, surface, wetting, capillary"};
  const ModuleInfo& info() const override { return kInfo; }

  Param<float> coefficient{
      *this,
      "coefficient",
      0.01f,
      {.unit = "N",
       .min = 0,
       .max = 1e9,  // beyond it forces leave the range of floats
       .softMax = 1,
       .live = true,
       .doc = "Energy per volume of the surface layer over half the squared gradient of the colour. Works "
              "from a support_ratio of 2; too much for dt makes the surface shake."}};
  Param<float> airPressure{
      *this,
      "air_pressure",
      0,
      {.unit = "Pa",
       .min = 0,
       .max = 1e9,
       .softMax = 100,
       .live = true,
       .doc = "Pressure of the air on free surfaces; it closes cavities that tension alone may open."}};

  /// Warns of a support too small for it.
  void reset(FluidStep& fluid) override;
  /// Of a coefficient that is too much for the step. The force is explicit, so κ·dt²/(ρ0·d⁴) has a bound:
  /// drops shake from about 1 on and fly apart at 4 (SurfaceTension.FliesApart… in the tests).
  void warn(const FluidOutlook& outlook) const override;
  void step(FluidStep& fluid) override {
    if (coefficient > 0 || airPressure > 0)
      dispatch(fluid.device, [&](auto& device) { stepOn(device, fluid); });
  }
  double memory(const FluidRoom& room) const override {
    return bytesOfArrays(room.particles, color_, stress_);
  }

 private:
  template <class Backend>
  void stepOn(Backend& device, FluidStep& fluid);

  Array<float> color_, stress_;
};

}  // namespace weir
