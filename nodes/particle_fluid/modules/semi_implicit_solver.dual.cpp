#include "nodes/particle_fluid/modules/semi_implicit_solver.h"

#include "nodes/particle_fluid/body_coupling.h"
#include "nodes/particle_fluid/fluid_sums.h"
#include "nodes/particle_fluid/modules/fused_substitution.h"
#include "nodes/particle_fluid/step_length.h"

namespace weir {

namespace {

/// x = x* + u + Δx.
struct Substitute {
  StepOf step;
  ArrayView<const Vec3f> predicted;
  ArrayView<Vec3f> displacement;
  ArrayView<Vec4f> state;

  template <class Index>
  WEIR_HD void operator()(Index i) const {
    step(i, [this](const auto& k, const auto& u, const auto& change) {
      const auto moved = u + change;
      write(displacement, k, moved);
      const auto x = read(predicted, k) + moved;
      write(state, k, {x.x, x.y, x.z, 0});
    });
  }
};

}  // namespace

template <class Backend>
void SemiImplicitSolver::stepOn(Backend& device, FluidStep& fluid) {
  const PressureProblem problem = problemOf(fluid);
  reserve(fluid, false);
  fluid.walls.forgetShares();
  // The same iterations in fewer passes, where nobody looks in between and no body moves.
  if (!searches() && !recordObjective && !fluid.walls.moves)
    return fluid.walls.withView(
        [&](const auto& walls) { FusedSubstitution(device, problem, walls).step(iterations); });

  const Count count = fluid.particles.count();
  const EnergyDerivative density = problem.derivative(excess_.view());
  const StepOf step = stepOf(problem);
  const Propose propose{step.pushOf, problem.displacement(), proposal_.view()};
  const Substitute substitute{.step = step,
                              .predicted = problem.predicted(),
                              .displacement = problem.displacement(),
                              .state = problem.state()};
  problem.start(device);
  fluid.exchange(problem.state());
  if (recordObjective) objective_->begin(fluid, iterations + 1);
  record(problem);
  for (int k = 0; k < iterations; ++k) {
    parallelForEights(device, "density", count, launched<SumAfterSum>(density));
    fluid.exchange(problem.weighted());
    if (searches()) parallelForEights(device, "propose", count, propose);
    if (stepLength == StepLength::kGlobal) {
      sumOverRanks(device, "measure", allOf(fluid), problem.square(), step.measure, AddSums{}, sums_.data());
      addBodyEnergy(device, problem, sums_.data());
    }
    parallelForEights(device, "update", count, substitute);
    moveBodies(device, problem, /*yields=*/true);
    fluid.exchange(problem.state());
    record(problem);
  }
  problem.finish(device);
  endBodies(device, fluid);
}

template void SemiImplicitSolver::stepOn(ThisBackend&, FluidStep&);

}  // namespace weir
