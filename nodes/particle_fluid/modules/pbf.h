// Position based fluids, the method that semi-implicit substitution is compared with.
//
// With g_ij = V0·∇_i W(r_ij) = V0·W'(r_ij)·(x_i − x_j)/r_ij, each iteration finds multipliers and moves every
// particle:
//
//   textbook       ℓ_i = −C_i / (Σ_j |g_ij|² + |Σ_j g_ij|² + ε),   Δx_i = Σ_j (ℓ_i + ℓ_j + s_ij)·g_ij
//                  C = max(λ, 1) − 1 (or λ − 1 with tension),      s_ij = −k·(W(r_ij)/W(0.2·H))⁴
//   unnormalized   ℓ_i = −ρ0·C_i / (Σ_j |∇W|² + |Σ_j ∇W|² + 0.1),  Δx_i = 10·Σ_j (ℓ_i + ℓ_j)·∇W    in SI
//   units
//
// The first is Macklin and Müller (2013), Eq. 8 to 14; ε = epsilon/d² and k = artificial_pressure·d² do not
// depend on the scale. The second is what the paper's comparisons show. As ∇W = g/V0, it is the first with ε
// = 0.1·V0² and a step 10·ρ0·V0 times as long: too short for fine particles, and unstable for coarse ones.
// `step` is that 10, which has to be tuned for each spacing. Both are symmetric in i and j, so every
// iteration conserves momentum. Velocities gain (x^N − x*)/dt.
#pragma once

#include "framework/base/api.h"
#include "framework/communication/on_ranks.h"
#include "framework/compute/dispatch.h"
#include "nodes/particle_fluid/fluid_module.h"
#include "nodes/particle_fluid/objective.h"

namespace WEIR_API weir {

enum class PbfForm { kTextbook, kUnnormalized };
template <>
struct EnumNames<PbfForm> {
  static constexpr std::array<EnumName, 2> kNames{
      EnumName{"textbook", "Macklin and Müller (2013); independent of the spacing."},
      EnumName{"unnormalized",
               "Gradients without the particle volume; the step grows with the spacing cubed."}};
};

class Pbf final : public FluidModule, public OnRanks {
 public:
  static constexpr ModuleInfo kInfo{
      "Pbf", kFamily,
      "Keeps the fluid incompressible by position based fluids; takes the place of the solver.",
      "position based, incompressible, pressure, solver"};
  const ModuleInfo& info() const override { return kInfo; }

  Param<PbfForm> form{
      *this, "form", PbfForm::kTextbook, {.live = true, .doc = "How multipliers and steps are scaled."}};
  Param<int> iterations{*this,
                        "iterations",
                        3,
                        {.min = 1,
                         .max = 10000,
                         .live = true,
                         .doc = "Iterations a step; neighbours are kept, densities are recomputed in each."}};
  Param<float> epsilon{*this,
                       "epsilon",
                       0.01f,
                       {.unit = "1/spacing^2",
                        .min = 0,
                        .aboveMin = true,
                        .softMin = 0.001,
                        .softMax = 1,
                        .live = true,
                        .doc = "Relaxation of the textbook form: more is softer, and safer where particles "
                               "have few neighbours."}};
  Param<float> artificialPressure{
      *this,
      "artificial_pressure",
      0,
      {.unit = "spacing^2",
       .min = 0,
       .softMax = 0.01,
       .live = true,
       .doc = "Repulsion of close particles in the textbook form, against clumps at free surfaces."}};
  Param<float> stepFactor{
      *this,
      "step",
      10,
      {.unit = "1/kg",
       .min = 0,
       .aboveMin = true,
       .softMin = 1,
       .softMax = 1000,
       .live = true,
       .doc = "Length of the unnormalized form's steps: 1/(rest_density * spacing^3) makes "
              "them as long as the textbook's."}};
  Param<bool> tension{
      *this,
      "tension",
      false,
      {.live = true, .doc = "Let fluid below rest density pull together; free surfaces then clump."}};
  Param<bool> recordObjective{
      *this,
      "record_objective",
      false,
      {.live = true,
       .doc =
           "Report the objective ψ of SemiImplicitSolver with b0 after each iteration of the last step, for "
           "studies of convergence."}};

  /// A scene Error for a parameter that the form does not have.
  void validate() const override;
  /// Of a spacing at which steps of the unnormalized form are far from those of the textbook.
  void warn(const FluidOutlook& outlook) const override;
  void step(FluidStep& fluid) override {
    dispatch(fluid.device, [&](auto& device) { stepOn(device, fluid); });
  }
  void report(NodeReport& report) override;
  double memory(const FluidRoom& room) const override {
    return bytesOfArrays(room.particles, state_, weighted_, displacement_);
  }

 private:
  template <class Backend>
  void stepOn(Backend& device, FluidStep& fluid);

  /// Where the iterations have come to, if that is recorded.
  void record(FluidStep& fluid);

  State<ObjectiveRecord> objective_{*this, "objective"};
  // Position and ℓ of each particle, before and after the pass of the multipliers; displacement x − x*.
  Array<Vec4f> state_, weighted_;
  Array<Vec3f> displacement_;
};

}  // namespace weir
