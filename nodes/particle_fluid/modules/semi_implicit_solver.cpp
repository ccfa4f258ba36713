#include "nodes/particle_fluid/modules/semi_implicit_solver.h"

namespace weir {

void SemiImplicitSolver::join(Communicator&) {
  if (stepLength == StepLength::kGlobal)
    throw sceneError("a step length of all particles together cannot be found on several ranks yet",
                     "\"full\" or \"particle\"", "or run without --ranks")
        .inParameter(stepLength.name());
  if (recordObjective)
    throw sceneError("the objective cannot be recorded on several ranks yet", "false",
                     "or run without --ranks")
        .inParameter(recordObjective.name());
}

void SemiImplicitSolver::warn(const FluidOutlook& outlook) const {
  warnOfFew(outlook, iterations, "an AcceleratedSolver");
}

void SemiImplicitSolver::report(NodeReport& report) {
  PressureSolver::report(report);
  report.statistics["solver_iterations"] = iterations.get();
}

}  // namespace weir
