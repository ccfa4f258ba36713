// Sums over all particles in the conjugate gradients of TwoProjections (two_projections.h).
#pragma once

#include "framework/base/host_device.h"

namespace weir::projection {

struct ProjectionSums {
  double curvature = 0;  ///< pᵀ·A·p
  double descent = 0;    ///< rᵀ·P·r
  double squares = 0;    ///< |r|²
};

struct AddSums {
  WEIR_HD ProjectionSums operator()(const ProjectionSums& a, const ProjectionSums& b) const {
    return {a.curvature + b.curvature, a.descent + b.descent, a.squares + b.squares};
  }
};

}  // namespace weir::projection
