// Semi-implicit successive substitution for incompressibility: the paper's Eq. 14 (or 12).
//
// With λ = ρ/ρ0, e = max(λ, 1) − 1 (or λ − 1 with tension), a_ij = (c·dt)²·V0·|W'(r_ij)|/r_ij and predicted
// positions x*, each iteration moves every particle by
//
//   Δx_i = α·[ (x*_i − x_i) − Σ_j (Ḃ_i + Ḃ_j)·a_ij·(x_j − x_i) ] / [ 1 + 2·|Ḃ⁻|·Σ_j a_ij ]
//
// which is Eq. 14 in displacement form with the sign of Eq. 8 corrected. The non-conservative form (Eq. 12)
// has Ḃ_i alone in place of the sum and a divisor of 1 + |Ḃ⁻|·Σ_j a_ij. Both directed contributions of a pair
// are known to each of its particles, so the update only gathers. Velocities gain (x^N − x*)/dt. The step
// length α is 1, or searched, see step_length.h.
#pragma once

#include "framework/base/api.h"
#include "framework/communication/on_ranks.h"
#include "framework/compute/dispatch.h"
#include "nodes/particle_fluid/pressure_solver.h"

namespace WEIR_API weir {

class SemiImplicitSolver final : public PressureSolver, public OnRanks {
 public:
  static constexpr ModuleInfo kInfo{
      "SemiImplicitSolver", kFamily,
      "Keeps the fluid incompressible by semi-implicit successive substitution.",
      "incompressible, pressure, compression"};
  const ModuleInfo& info() const override { return kInfo; }

  Param<int> iterations{*this,
                        "iterations",
                        3,
                        {.min = 1,
                         .max = 10000,
                         .live = true,
                         .doc = "Iterations a step; neighbours are kept, densities are recomputed in each."}};

  /// Of too few iterations for the step.
  void warn(const FluidOutlook& outlook) const override;
  void step(FluidStep& fluid) override {
    dispatch(fluid.device, [&](auto& device) { stepOn(device, fluid); });
  }
  void report(NodeReport& report) override;

 private:
  template <class Backend>
  void stepOn(Backend& device, FluidStep& fluid);
};

}  // namespace weir
