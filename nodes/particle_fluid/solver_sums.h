// What the iterations of a pressure solver sum over all particles.
#pragma once

#include "framework/base/host_device.h"

namespace weir {

/// Sums of max(λ − 1, 0), of E, of |g·Δx|; the largest square of a way since the last search, m².
struct SolverSums {
  double compression = 0, objective = 0, slope = 0, farthest = 0;
};

struct AddSums {
  WEIR_HD SolverSums operator()(const SolverSums& a, const SolverSums& b) const {
    return {a.compression + b.compression, a.objective + b.objective, a.slope + b.slope,
            a.farthest > b.farthest ? a.farthest : b.farthest};
  }
};

}  // namespace weir
