// Semi-implicit successive substitution for incompressibility: the paper's Eq. 14 (or 12).
//
// With λ = ρ/ρ0, e = max(λ, 1) − 1 (or λ − 1 with tension), a_ij = (c·dt)²·V0·|W'(r_ij)|/r_ij and predicted
// positions x*, each iteration moves every particle by
//
//   Δx_i = α·[ (x*_i − x_i) − Σ_j (Ḃ_i + Ḃ_j)·a_ij·(x_j − x_i) ] / [ 1 + 2·|Ḃ⁻|·Σ_j a_ij ]
//
// which is Eq. 14 in displacement form with the sign of Eq. 8 corrected. The non-conservative form (Eq. 12)
// has Ḃ_i alone in place of the sum and a divisor of 1 + |Ḃ⁻|·Σ_j a_ij. Both directed contributions of a pair
// are known to each of its particles, so the update only gathers. Velocities gain (x^N − x*)/dt.
//
// The step length α is 1, or searched: the linear model may not take an objective E ≥ 0 below zero, so
// α = min(1, E/|g·Δx|) with E_i = |x_i − x*_i|²/2 + (c·dt)²·B(λ_i) and its gradient g_i, of each particle or
// of all together.
//
// With a tolerance, iterations end when the mean of max(λ − 1, 0) is not above it; with momentum, u being the
// displacement x − x* and f(u) what an iteration makes of it,
//
//   û_k = f(u_k),   u_k+1 = û_k + k/(k + 3)·(û_k − û_k−1)        (Nesterov)
//
// or Anderson's acceleration (anderson.h); and u_k is put back to û_k−1, and k to 0, where Σ E has risen.
// With tolerance or acceleration, particles are kept out of the solids in every iteration.
//
// With a tolerance, particles that fly further than a spacing are led to x* in stages: the same problem is
// solved with x* − (1 − s/n)·dt·v* in place of x* for s = 1 … n, each from the displacement of the one before
// and with neighbours of its own. The last of them is the step's own problem. Started at x* itself, fluid
// that flies at a wall would lie flat on it, layer upon layer, and come apart in another order: a minimum of
// the objective, too, but none that a flow leads to. n is found on the device.
#pragma once

#include <optional>

#include "framework/compute/readback.h"
#include "nodes/particle_fluid/bulk_energy.h"
#include "nodes/particle_fluid/fluid_module.h"
#include "nodes/particle_fluid/modules/anderson.h"
#include "nodes/particle_fluid/modules/semi_implicit_control.h"
#include "nodes/particle_fluid/objective.h"

namespace weir {

enum class StepLength { kFull, kParticle, kGlobal };
template <>
struct EnumNames<StepLength> {
  static constexpr std::array<EnumName, 3> kNames{
      EnumName{"full", "No search; enough for b0."},
      EnumName{"particle", "Each particle's own, against overshooting."},
      EnumName{"global", "One for all particles, which keeps displacements of pairs opposite."}};
};

enum class Acceleration { kNone, kNesterov, kAnderson };
template <>
struct EnumNames<Acceleration> {
  static constexpr std::array<EnumName, 3> kNames{
      EnumName{"none", "As in the paper."},
      EnumName{"nesterov", "Nesterov's momentum, taken back where the objective would rise."},
      EnumName{"anderson",
               "The best mixture of the last four iterates, taken back where the objective would rise."}};
};

class SemiImplicitSolver final : public FluidModule {
 public:
  static constexpr ModuleInfo kInfo{
      "SemiImplicitSolver", kFamily,
      "Keeps the fluid incompressible by semi-implicit successive substitution."};
  const ModuleInfo& info() const override { return kInfo; }

  Param<int> iterations{
      *this,
      "iterations",
      3,
      {.min = 1,
       .max = 10000,
       .live = true,
       .doc = "Iterations a step; neighbours are kept, densities are recomputed in each. "
              "The most of them, after each search for neighbours, where a tolerance is given."}};
  Param<std::optional<float>> tolerance{
      *this,
      "tolerance",
      {},
      {.min = 1e-6,
       .max = 1,
       .doc = "Iterate until the mean compression, that of max(λ - 1, 0), is not above this. With pressure p "
              "it cannot fall below p/bulk_modulus."}};
  Param<bool> conservative{
      *this,
      "conservative",
      true,
      {.live = true,
       .doc = "Equal and opposite displacements (Eq. 14), or each particle's own terms only (Eq. 12)."}};
  Param<bool> tension{
      *this,
      "tension",
      false,
      {.live = true, .doc = "Let fluid below rest density pull together; free surfaces then clump."}};
  Param<EnergyName> energy{
      *this, "energy", EnergyName::kB0, {.doc = "Bulk energy B of the relative density λ."}};
  Param<std::vector<float>> polynomial{
      *this,
      "polynomial",
      {},
      {.min = 0,
       .doc = "c1, c2, … of the derivative of B, the sum of c_k (λ^k - 1); for energy: polynomial."}};
  Param<StepLength> stepLength{
      *this, "step_length", StepLength::kFull, {.doc = "How far along its direction an update goes."}};
  Param<Acceleration> acceleration{
      *this, "acceleration", Acceleration::kNone, {.doc = "How iterations build on earlier ones."}};
  Param<std::optional<int>> neighborSearches{
      *this,
      "neighbor_searches",
      std::nullopt,
      {.min = 1,
       .max = 100,
       .doc =
           "How often neighbours are found in a step: at the predicted positions, and then again where "
           "the iterations have led, which go on from there. If it is left out, 1 without a tolerance, and "
           "with "
           "one 3, and more (at most 10 in each stage) as long as a particle has been moved by more than a "
           "quarter of a spacing since the last."}};
  Param<int> pathStages{
      *this,
      "path_stages",
      16,
      {.min = 1,
       .max = 100,
       .doc =
           "At most this many stages, of a spacing each, on the way to predicted positions that are further "
           "away; only with a tolerance, and where the fluid meets no meshes. With 1 there are none."}};
  Param<bool> recordObjective{*this,
                              "record_objective",
                              false,
                              {.live = true,
                               .doc = "Report the objective ψ (Eq. 7) after each iteration of the last step, "
                                      "for studies of convergence."}};

  void validate() const override;
  void reset(FluidStep& fluid) override;
  /// Of too few iterations for the step, and of a tolerance below the compression of the fluid at rest.
  void warn(const FluidOutlook& outlook) const override;
  void step(FluidStep& fluid) override {
    dispatch(fluid.device, [&](auto& device) { stepOn(device, fluid); });
  }
  void report(NodeReport& report) override;
  double memory(const FluidRoom& room) const override;

  using Sums = SolverSums;
  using Control = SolverControl;

 private:
  template <class Backend>
  void stepOn(Backend& device, FluidStep& fluid);
  /// Counts, and finds the stages of the way to the predicted positions.
  template <class Backend>
  void beginStep(Backend& device, FluidStep& fluid);
  /// Displacements of 0.
  template <class Backend>
  void start(Backend& device, FluidStep& fluid);
  /// The paper's iterations, and no more.
  template <class Backend>
  void substitute(Backend& device, FluidStep& fluid);
  /// With what tolerance, acceleration and step-length search add.
  template <class Backend>
  void iterate(Backend& device, FluidStep& fluid, int pass);
  /// Moves particles out of solids; only where iterations are controlled, and not where *done, on the device,
  /// is not 0.
  template <class Backend>
  void contain(Backend& device, FluidStep& fluid, const int* done = nullptr);
  /// Finds neighbours where the particles are now.
  template <class Backend>
  void searchAgain(Backend& device, FluidStep& fluid);
  void reserve(FluidStep& fluid);
  /// Whether the displacement is an attribute of the particles.
  bool carries() const { return passes() > 1 || tolerance.get().has_value(); }
  /// As far as the host has heard of it, without waiting.
  bool isDone();
  /// Hears whether there is another pass. Waits where this may have been the last: a pass too many would sort
  /// and round once more, and how many there were would depend on the time that the host takes.
  void endPass(int pass);
  bool isPlain() const { return !controlled() && !searches() && passes() == 1 && !recordObjective; }
  bool controlled() const { return tolerance.get().has_value() || accelerated(); }
  bool accelerated() const { return acceleration != Acceleration::kNone; }
  bool mixes() const { return acceleration == Acceleration::kAnderson; }
  /// Whether long ways to predicted positions are gone in stages. Meshes stop particles on this way by
  /// changing their velocities, which then do not lead back along it.
  bool staged(const FluidStep& fluid) const;
  /// Of a stage, where its iterations lead so far that their neighbours no longer hold.
  int maxRepeats() const;
  /// The most of a step.
  int maxPasses() const;
  int passes() const { return neighborSearches.get().value_or(tolerance.get() ? 3 : 1); }
  bool searches() const { return stepLength != StepLength::kFull; }

  /// Where the iterations have come to, if that is recorded.
  void record(FluidStep& fluid);

  BulkEnergy bulkEnergy_;
  State<ObjectiveRecord> objective_{*this, "objective"};
  // Positions, what the density pass makes of them, and displacements stand in the particles' scratch memory.
  // Only where they are needed: max(e, 0); Δx and |g·Δx|; the displacement by the last plain update, for
  // momentum.
  Array<float> excess_;
  Array<Vec4f> proposal_;
  Array<Vec3f> plain_;
  Array<float> plainShare_;
  AndersonMixing mixing_;
  Array<Vec3f>* carried_ = nullptr;  // the displacement, as an attribute that sorting puts into its order
  Array<Sums> sums_;
  State<Array<Control>> control_{*this, "control"};
  std::optional<Readback<Control>> controlSeen_;
  State<std::int64_t> passes_{*this, "passes"};  // begun, as Control::passes
  Array<float> farthest_;  // one number: the largest square of a displacement to a predicted position, m²
  bool over_ = false;      // whether the host knows that a step makes no other pass
};

}  // namespace weir
