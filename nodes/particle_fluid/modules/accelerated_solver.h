// The problem of SemiImplicitSolver (pressure_problem.h), solved to a tolerance, with acceleration.
//
// Iterations end when the mean of max(λ − 1, 0) is not above the tolerance and, along conjugate directions,
// the last of them has lowered the objective by little (GainTolerance). They go along conjugate directions
// (conjugate.h); or, u being the displacement x − x* and f(u) what an iteration of
// SemiImplicitSolver makes of it, with momentum,
//
//   û_k = f(u_k),   u_k+1 = û_k + k/(k + 3)·(û_k − û_k−1)        (Nesterov)
//
// Where Σ E has risen, the last step is taken back. With each, particles are kept out of the solids in every
// iteration.
//
// With a tolerance, particles that fly further than a spacing are led to x* in stages: the same problem is
// solved with x* − (1 − s/n)·dt·v* in place of x* for s = 1 … n, each from the displacement of the one before
// and with neighbours of its own. The last of them is the step's own problem. Started at x* itself, fluid
// that flies at a wall would lie flat on it, layer upon layer, and come apart in another order: a minimum of
// the objective, too, but none that a flow leads to. n is found on the device.
#pragma once

#include <optional>

#include "framework/base/api.h"
#include "framework/communication/on_ranks.h"
#include "framework/compute/dispatch.h"
#include "framework/compute/readback.h"
#include "framework/graph/moved_parameters.h"
#include "nodes/particle_fluid/modules/accelerated_control.h"
#include "nodes/particle_fluid/modules/conjugate.h"
#include "nodes/particle_fluid/pressure_solver.h"

namespace WEIR_API weir {

struct Contain;
namespace detail {
struct GainTolerance;
struct Judge;
struct Settle;
}  // namespace detail

enum class Acceleration { kAuto, kNone, kNesterov, kConjugate };
template <>
struct EnumNames<Acceleration> {
  static constexpr std::array<EnumName, 4> kNames{
      EnumName{"auto",
               "conjugate; or nesterov with a RigidBody in the fluid, with forces that are not conservative, "
               "and with a step_length that is searched, for which conjugate is not made."},
      EnumName{"none", "Iterations as in the paper."},
      EnumName{"nesterov", "Nesterov's momentum, taken back where the objective would rise."},
      EnumName{"conjugate",
               "Conjugate gradients, with a search for the length of each step: the fewest iterations."}};
};

class AcceleratedSolver final : public PressureSolver, public OnRanks {
 public:
  static constexpr ModuleInfo kInfo{
      "AcceleratedSolver", kFamily,
      "Keeps the fluid incompressible to a tolerance, by accelerated substitution; takes the place of the "
      "solver.",
      "incompressible, pressure, compression, faster, tolerance, convergence"};
  const ModuleInfo& info() const override { return kInfo; }

  Param<std::optional<float>> tolerance{
      *this,
      "tolerance",
      1e-3f,
      {.min = 1e-6,
       .max = 1,
       .doc = "Iterate until the mean compression, that of max(λ - 1, 0), is not above this. With pressure p "
              "it cannot fall below p/bulk_modulus. With null all iterations are made."}};
  Param<int> maxIterations{
      *this,
      "max_iterations",
      1000,
      {.min = 1,
       .max = 10000,
       .live = true,
       .doc = "The most of a step, which then goes on with what they have come to. With neighbor_searches or "
              "without a tolerance: after each search for neighbours."}};
  Param<Acceleration> acceleration{
      *this, "acceleration", Acceleration::kAuto, {.doc = "How iterations build on earlier ones."}};
  Param<std::optional<int>> neighborSearches{
      *this,
      "neighbor_searches",
      std::nullopt,
      {.min = 1,
       .max = 100,
       .doc =
           "How often neighbours are found in a step: at the predicted positions, and then again where "
           "the iterations have led, which go on from there. If it is left out, 1 without a tolerance. With "
           "one, as long as a particle has been moved by more than a tenth of a spacing since the last, 3 "
           "times at most, or 10 in each stage where it has been moved by more than a quarter."}};
  Param<int> pathStages{
      *this,
      "path_stages",
      16,
      {.min = 1,
       .max = 100,
       .doc =
           "At most this many stages, of a spacing each, on the way to predicted positions that are further "
           "away; only with a tolerance, and where the fluid meets no meshes. With 1 there are none."}};

  void validate() const override;
  void reset(FluidStep& fluid) override;
  /// Of too few iterations for the step, and of a tolerance below the compression of the fluid at rest.
  void warn(const FluidOutlook& outlook) const override;
  void step(FluidStep& fluid) override {
    dispatch(fluid.device, [&](auto& device) { stepOn(device, fluid); });
  }
  void report(NodeReport& report) override;
  double memory(const FluidRoom& room) const override;
  std::optional<double> toleratedCompression() const override {
    if (!tolerance.get()) return {};
    return *tolerance.get();
  }

  using Control = SolverControl;

 private:
  template <class Backend>
  void stepOn(Backend& device, FluidStep& fluid);
  void reserve(FluidStep& fluid);
  /// Where the acceleration cannot move bodies.
  void refuseBodies(const FluidStep& fluid) const;
  /// In the first step, as solids come after reset().
  void askForCurvature(FluidStep& fluid);
  /// Counts, and finds the stages of the way to the predicted positions.
  template <class Backend>
  void beginStep(Backend& device, FluidStep& fluid);
  /// The iterations with the neighbours of one search.
  template <class Backend>
  void iterate(Backend& device, const PressureProblem& problem, int pass);
  /// The same by conjugate gradients.
  template <class Backend>
  void iterateConjugate(Backend& device, const PressureProblem& problem, int pass);
  template <class Backend>
  void iterateOnce(Backend& device, const PressureProblem& problem, ArrayView<const Vec3f> searched,
                   bool last);
  /// λ and Ḃ at the displacements, where λ has to be summed; `first` of a pass.
  template <class Backend>
  void settle(Backend& device, const PressureProblem& problem, bool first);
  detail::Settle settleOf(const PressureProblem& problem, bool first);
  /// Decides on the device how to go on; `last` is the last iteration of a pass.
  template <class Backend>
  void judge(Backend& device, const PressureProblem& problem, bool last);
  detail::GainTolerance gainTolerance(const PressureProblem& problem) const;
  detail::Judge judgeOf(const PressureProblem& problem, const SolverSums* sums, bool last);
  /// Builds on earlier iterations, or goes back to the one before.
  template <class Backend>
  void accelerate(Backend& device, const PressureProblem& problem);
  /// Moves particles out of solids; only where iterations are controlled, and not where *done, on the device,
  /// is not 0.
  template <class Backend>
  void contain(Backend& device, const PressureProblem& problem, const int* done = nullptr);
  /// What does that, of displacements whose positions are the state.
  static Contain containOf(const PressureProblem& problem, ArrayView<Vec3f> displacement, const int* done,
                           ArrayView<Vec3f> held = {});
  /// What of the displacement by walls is not in the shares goes to `before`, where a boundary is felt, or to
  /// the meshes.
  template <class Backend>
  void divideHeld(Backend& device, const PressureProblem& problem, ArrayView<Vec3f> before);
  /// What walls do beside holding the fluid.
  template <class Backend>
  void meetWalls(Backend& device, const PressureProblem& problem);
  /// Finds neighbours where the particles are now.
  template <class Backend>
  void searchAgain(Backend& device, PressureProblem& problem);
  /// Whether the displacement is an attribute of the particles.
  bool carries() const { return passes() > 1 || tolerance.get().has_value(); }
  /// Waits for what the device has decided in the last iteration; if it is done, for what follows, too.
  bool isDone();
  /// Hears whether there is another pass after one with the most iterations. Waits where this may have been
  /// the last: a pass too many would sort and round once more, and how many there were would depend on the
  /// time that the host takes.
  void endPass(int pass);
  bool controlled() const { return tolerance.get().has_value() || accelerated(); }
  bool accelerated() const { return chosen() != Acceleration::kNone; }
  bool hasMomentum() const { return chosen() == Acceleration::kNesterov; }
  bool conjugates() const { return chosen() == Acceleration::kConjugate; }
  /// Whether the displacement by walls is followed.
  bool followsHeld() const { return held_ && conjugates(); }
  /// With `held` where that is followed.
  ConjugateView conjugateView();
  /// What `auto` means here.
  Acceleration chosen() const;
  /// Whether long ways to predicted positions are gone in stages. Meshes stop particles on this way by
  /// changing their velocities, which then do not lead back along it.
  bool staged(const FluidStep& fluid) const;
  /// Of a stage, where its iterations lead so far that their neighbours no longer hold.
  int maxRepeats() const;
  /// The most of a step.
  int maxPasses() const;
  int passes() const { return neighborSearches.get().value_or(tolerance.get() ? 3 : 1); }

  // The displacement by the last plain update, for momentum, and the walls' share in it.
  Array<Vec3f> plain_;
  Array<float> plainShare_;
  ConjugateDirections directions_;
  // Where boundaries report forces, and with meshes along conjugate directions: the displacement by walls,
  // their pressure and what keeps particles out, m; after a step what meshes have of it beside their shares.
  Attribute<Vec3f> held_;
  Attribute<Vec3f> carried_;  // the displacement, as an attribute that sorting puts into its order
  State<Array<Control>> control_{*this, "control"};
  std::optional<Readback<Control>> controlSeen_;
  Count all_;                                    // particles of all ranks, since the last search
  State<std::int64_t> passes_{*this, "passes"};  // begun, as Control::passes
  Array<float> farthest_;  // one number: the largest square of a displacement to a predicted position, m²
  bool besideBodies_ = false;  // whether the fluid moves solids
  bool over_ = false;          // whether the host knows that a step makes no other pass
};

/// What scenes give SemiImplicitSolver that were written when it had these parameters.
std::unique_ptr<MovedParameters> movedFromSemiImplicitSolver();

}  // namespace weir
