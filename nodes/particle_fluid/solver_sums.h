// What the iterations of a pressure solver sum over all particles.
#pragma once

#include "framework/compute/exact_sum.h"

namespace weir {

/// Sums of max(λ − 1, 0), of E, of |g·Δx|; the largest square of a way since the last search, m²; and of
/// |u|²/2, u being the displacement, where it is asked for.
struct SolverSums {
  double compression = 0, objective = 0, slope = 0, farthest = 0, displaced = 0;

  /// Of the k-th, for sums over ranks (exact_sum.h).
  WEIR_HD static constexpr SumKind kindOf(int k) {
    constexpr int kCompression = 0, kFarthest = 3;
    return k == kCompression ? SumKind::kNumber : k == kFarthest ? SumKind::kMax : SumKind::kScaled;
  }
};

struct AddSums {
  WEIR_HD SolverSums operator()(const SolverSums& a, const SolverSums& b) const {
    return {a.compression + b.compression, a.objective + b.objective, a.slope + b.slope,
            a.farthest > b.farthest ? a.farthest : b.farthest, a.displaced + b.displaced};
  }
};

}  // namespace weir
