#include "nodes/particle_fluid/modules/semi_implicit_solver.h"

namespace weir {

namespace {
template <class T>
void fit(Array<T>& array, Device& device, std::int64_t size) {
  if (array.data() == nullptr) array = Array<T>(device);
  array.resize(size);
}
}  // namespace

void SemiImplicitSolver::reserve(FluidStep& fluid) {
  const std::int64_t size = fluid.particles.positions().size();
  fit(state_, fluid.device, size);
  fit(weighted_, fluid.device, size);
  fit(displacement_, fluid.device, size);
}

void SemiImplicitSolver::report(NodeReport& report) {
  report.statistics["solver_iterations"] = iterations.get();
}

}  // namespace weir
