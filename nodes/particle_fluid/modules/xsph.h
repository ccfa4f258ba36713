// XSPH artificial viscosity. A sweep is that of Schechter and Bridson (2012):
//
//   v_i ← v_i + c·Σ_j V0·(v_j − v_i)·W(r_ij)
//
// Equal volumes make the exchange symmetric, so momentum is conserved. A sweep with c ≤ 1 is stable, because
// V0·ΣW ≤ λ. Its forms are
//
// per_time: n sweeps a step with c = rate·dt/n, n = 1 where rate·dt ≤ 1. Motion that is smooth over the
// support decays by rate·dt·V0·Σ(1 − cos)·W in a step, so as much in a time, whatever dt is.
//
// explicit, as the paper has it: one sweep a step with c = strength, which has no unit. How viscous the fluid
// is depends on the number of steps a second.
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
// On CUDA the first sweep reads positions and velocities from codes (motion_code.h) where the solver has just
// left them: weights are then right to 1e-4 of W(0), and velocities to 1e-5 of themselves.
#pragma once

#include "framework/base/api.h"
#include "framework/communication/on_ranks.h"
#include "framework/graph/moved_parameters.h"
#include "nodes/particle_fluid/fluid_module.h"

namespace WEIR_API weir {

enum class XsphForm { kPerTime, kExplicit, kImplicit };
template <>
struct EnumNames<XsphForm> {
  static constexpr std::array<EnumName, 3> kNames{
      EnumName{"per_time", "Differences decay at `rate`, whatever the time step; conserves momentum."},
      EnumName{"explicit",
               "Removes the share `strength` of the differences in each step, as the paper does; conserves "
               "momentum."},
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
      *this, "form", XsphForm::kPerTime, {.live = true, .doc = "How velocities are smoothed."}};
  Param<float> rate{*this,
                    "rate",
                    300,
                    {.unit = "1/s",
                     .min = 0,
                     .softMax = 1000,
                     .live = true,
                     .animated = true,
                     .doc = "Rate at which differences to the neighbours' velocities decay.",
                     .onlyFor = "form: per_time",
                     .also = "viscosity, strength"}};
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
  /// Of a rate that takes many sweeps a step.
  void warn(const FluidOutlook& outlook) const override;
  void step(FluidStep& fluid) override;
  double memory(const FluidRoom& room) const override;

 private:
  /// One with c = share.
  template <class Backend>
  void sweepOn(Backend& device, FluidStep& fluid, float share);
  void smooth(FluidStep& fluid, double share, int sweeps);
  template <class Backend>
  void implicitOn(Backend& device, FluidStep& fluid);

  Array<Vec3f> next_;  // of the implicit form
};

/// A strength without a form, from when all of XSPH counted in steps, is that of the form explicit.
std::unique_ptr<MovedParameters> strengthOfXsph();

}  // namespace weir
