#include "nodes/particle_fluid/modules/semi_implicit_solver.h"

namespace weir {

void SemiImplicitSolver::warn(const FluidOutlook& outlook) const {
  warnOfFew(outlook, iterations, "an AcceleratedSolver");
}

void SemiImplicitSolver::report(NodeReport& report) {
  PressureSolver::report(report);
  report.statistics["solver_iterations"] = iterations.get();
}

}  // namespace weir
