// Divergence-free SPH: J. Bender, D. Koschier, "Divergence-Free SPH for Incompressible and Viscous Fluids",
// IEEE TVCG 23(3), 2017. Takes the place of the module "solver".
//
// Two solvers make one step. The first keeps the density: with λ = ρ/ρ0 at the predicted positions x*, it
// finds pressures p_i ≥ 0 (per rest density, m²/s²) whose displacements
//
//   u_i = −dt²·(Σ_j (p_i + p_j)·g_ij + 2·p_i·∇Φ_i),      g_ij = V0·∇_i W(r_ij)
//
// lead to no more than rest density: λ_i + Σ_j g_ij·(u_i − u_j) + ∇Φ_i·u_i ≤ 1. Then x = x* + u, v = v* +
// u/dt. The second does the same with dt·Dλ_i/Dt of the new velocities in place of λ_i − 1, and changes
// velocities alone, so that the next step starts without compression in it.
//
// Both iterate p_i ← max(0, p_i + ω·r_i/(dt²·D_i)), where r is what is left of the error and D_i, the paper's
// 1/α_i, is how much r_i falls for p_i alone:
//
//   D_i = (G_i + ∇Φ_i)·(G_i + 2·∇Φ_i) + Σ_j |g_ij|²,     G_i = Σ_j g_ij
//
// until the mean of max(r, 0) over all particles is below a tolerance. Φ and ∇Φ are what solids add
// (nodes/particle_fluid/wall_field.h); they act as mirrored fluid. Where the paper predicts the density from
// velocities at x, this takes it at x*, where Weir has found the neighbours. The pressures of the density
// solver are where the next step begins.
#pragma once

#include <weir/fluid_module.h>

namespace dfsph {

using namespace weir;

/// What one of the two solvers did, over all steps since the reset.
struct SolverRecord {
  std::int64_t iterations = 0, steps = 0, unfinished = 0;
  double error = 0;  ///< of the last step
  double maxError = 0;
};

class Dfsph final : public FluidModule {
 public:
  static constexpr ModuleInfo kInfo{
      "Dfsph", kFamily,
      "Keeps the fluid incompressible by divergence-free SPH; takes the place of the solver."};
  const ModuleInfo& info() const override { return kInfo; }

  Param<float> tolerance{*this,
                         "tolerance",
                         1e-4f,
                         {.min = 1e-6,
                          .max = 1,
                          .live = true,
                          .doc = "Iterate until the mean of max(ρ/ρ0 - 1, 0) is not above this."}};
  Param<float> divergenceTolerance{
      *this,
      "divergence_tolerance",
      1e-4f,
      {.min = 1e-6,
       .max = 1,
       .live = true,
       .doc = "Iterate until the mean of what ρ/ρ0 would grow in one step is not above this."}};
  Param<int> maxIterations{*this,
                           "max_iterations",
                           200,
                           {.min = 1, .max = 10000, .live = true, .doc = "Of each solver, in a step."}};
  Param<bool> divergenceFree{
      *this, "divergence_free", true, {.live = true, .doc = "Whether the second solver runs."}};

  /// Adds the attribute "pressure".
  void reset(FluidStep& fluid) override;
  /// Waits for the device after every iteration, as the number of iterations follows from the error.
  void step(FluidStep& fluid) override {
    dispatch(fluid.device, [&](auto& device) { stepOn(device, fluid); });
  }
  void report(NodeReport& report) override;

 private:
  template <class Backend>
  void stepOn(Backend& device, FluidStep& fluid);
  /// Iterates from the pressures in state_ until they meet the tolerance; displacement_ is theirs.
  template <class Backend>
  void solve(Backend& device, FluidStep& fluid, float until, SolverRecord& record);
  void fit(FluidStep& fluid);

  State<SolverRecord> density_{*this, "density"}, divergence_{*this, "divergence"};
  Attribute<float> pressure_;  // Pa, of the fluid's particles
  // Position and p of each particle, in this iteration and the next.
  Array<Vec4f> state_, next_;
  Array<Vec3f> displacement_;
  Array<float> source_, diagonal_, error_, errorSum_;
};

}  // namespace dfsph
