#include "apps/weir/bench/byte_model.h"

namespace weir::app {

double minBytesOfStep(const StepPasses& passes, double neighbors) {
  const double list = 4 * neighbors;
  const double solver = (passes.iterations - 1) * (20 + list) + passes.iterations * (36 + list);
  const double viscosity = passes.viscositySweeps * (48 + list);
  return 64 + (24 + list) + solver + viscosity + 80;
}

}  // namespace weir::app
