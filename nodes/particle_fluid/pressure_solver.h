// What the solvers of the pressure problem (pressure_problem.h) have in common: the parameters that say which
// problem it is, and the memory and the record of their iterations.
#pragma once

#include "framework/base/api.h"
#include "framework/compute/array.h"
#include "nodes/particle_fluid/bulk_energy.h"
#include "nodes/particle_fluid/fluid_module.h"
#include "nodes/particle_fluid/objective.h"
#include "nodes/particle_fluid/pressure_law.h"
#include "nodes/particle_fluid/solver_sums.h"

namespace WEIR_API weir {

struct PressureProblem;
struct StepOf;

enum class StepLength { kFull, kParticle, kGlobal };
template <>
struct EnumNames<StepLength> {
  static constexpr std::array<EnumName, 3> kNames{
      EnumName{"full", "No search; enough for b0."},
      EnumName{"particle", "Each particle's own, against overshooting."},
      EnumName{"global", "One for all particles, which keeps displacements of pairs opposite."}};
};

class PressureSolver : public FluidModule, public PressureLaw {
 public:
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
  Param<std::vector<float>> polynomial{*this,
                                       "polynomial",
                                       {},
                                       {.min = 0,
                                        .doc = "c1, c2, … of the derivative of B, the sum of c_k (λ^k - 1).",
                                        .onlyFor = "energy: polynomial"}};
  Param<StepLength> stepLength{
      *this, "step_length", StepLength::kFull, {.doc = "How far along its direction an update goes."}};
  Param<bool> recordObjective{*this,
                              "record_objective",
                              false,
                              {.live = true,
                               .doc = "Report the objective ψ (Eq. 7) after each iteration of the last step, "
                                      "for studies of convergence."}};

  void validate() const override;
  void reset(FluidStep& fluid) override;
  void report(NodeReport& report) override;
  double memory(const FluidRoom& room) const override;
  const BulkEnergy& bulkEnergy() const override { return bulkEnergy_; }

 protected:
  PressureProblem problemOf(FluidStep& fluid) const;
  /// What an iteration moves particles by; `searched` has the displacements at the last search for
  /// neighbours, if they are not all 0.
  StepOf stepOf(const PressureProblem& problem, ArrayView<const Vec3f> searched = {}) const;
  /// For the length of a step.
  bool searches() const { return stepLength != StepLength::kFull; }
  /// Makes room for `excess_` where it is asked for, and for what a search of the step length needs.
  void reserve(FluidStep& fluid, bool excess);
  /// Where the iterations have come to, if that is recorded.
  void record(const PressureProblem& problem);
  /// Warns of a step that this number of iterations leaves compressed.
  void warnOfFew(const FluidOutlook& outlook, int iterations, const std::string& another) const;

  BulkEnergy bulkEnergy_;
  State<ObjectiveRecord> objective_{*this, "objective"};
  Array<SolverSums> sums_;
  // Only where they are needed: max(e, 0); Δx and |g·Δx|.
  Array<float> excess_;
  Array<Vec4f> proposal_;
};

}  // namespace weir
