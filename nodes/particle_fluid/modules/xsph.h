// XSPH artificial viscosity, in two forms.
//
// explicit, of Schechter and Bridson (2012), with c = strength, which has no unit:
//
//   v_i ← v_i + c·Σ_j V0·(v_j − v_i)·W(r_ij)
//
// Equal volumes make the exchange symmetric, so momentum is conserved. One sweep with c ≤ 1 is stable,
// because V0·ΣW ≤ λ. How viscous the fluid is depends on the number of steps a second.
//
// implicit, with ν = viscosity in m/s:
//
//   v_i = (v_i⁰ + b·v̄_i)/(1 + b),   b = dt·ν/H,   v̄_i = Σ_j W(r_ij)·v_j / Σ_j W(r_ij)
//
// by three Jacobi sweeps. ν/H is the rate at which differences to the neighbours decay, so the effect over
// time does not depend on dt while b is small. It is that of a kinematic viscosity of ν·⟨r²⟩/(6·H), with the
// mean over neighbours weighted by W: ν·H/13 (in m²/s) on a lattice with H = 1.5d, ν·H/28 in the limit of
// many neighbours. Each sweep takes means with weights that add up to 1, so no b, however large, is unstable.
// Momentum is conserved only as far as ΣW is the same for all particles.
//
// On CUDA the explicit form reads positions and velocities from codes (motion_code.h) where the solver has
// just left them: weights are then right to 1e-4 of W(0), and velocities to 1e-5 of themselves.
#pragma once

#include "framework/base/api.h"
#include "framework/communication/on_ranks.h"
#include "nodes/particle_fluid/fluid_module.h"

namespace WEIR_API weir {

enum class XsphForm { kExplicit, kImplicit };
template <>
struct EnumNames<XsphForm> {
  static constexpr std::array<EnumName, 2> kNames{
      EnumName{"explicit",
               "Removes the share `strength` of the differences in each step; conserves momentum."},
      EnumName{"implicit",
               "Differences decay at the rate viscosity / support radius; stable for any viscosity."}};
};

class Xsph final : public FluidModule, public OnRanks {
 public:
  static constexpr ModuleInfo kInfo{"Xsph", kFamily,
                                    "Smooths velocities between neighbours (artificial viscosity).",
                                    "viscosity, viscous, smoothing, thick, honey"};
  const ModuleInfo& info() const override { return kInfo; }

  Param<XsphForm> form{
      *this, "form", XsphForm::kExplicit, {.live = true, .doc = "How velocities are smoothed."}};
  Param<float> strength{*this,
                        "strength",
                        0.3f,
                        {.min = 0,
                         .max = 1,
                         .live = true,
                         .animated = true,
                         .doc = "Share of the difference to the neighbours' velocities that is removed in a "
                                "step.",
                         .onlyFor = "form: explicit",
                         .also = "viscosity"}};
  Param<float> viscosity{
      *this,
      "viscosity",
      1,
      {.unit = "m/s",
       .min = 0,
       .softMax = 100,
       .live = true,
       .animated = true,
       .doc = "Rate at which differences to the neighbours decay, times the support radius.",
       .onlyFor = "form: implicit"}};

  void reset(FluidStep& fluid) override;
  void step(FluidStep& fluid) override;
  double memory(const FluidRoom& room) const override;

 private:
  template <class Backend>
  void stepOn(Backend& device, FluidStep& fluid);
  template <class Backend>
  void implicitOn(Backend& device, FluidStep& fluid);

  Array<Vec3f> next_;  // of the implicit form
};

}  // namespace weir
