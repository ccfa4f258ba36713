// A square root of a body's inverse mass: M⁻¹ = L·Lᵀ, so that a row of an impulse needs only J·L.
#pragma once

#include <BulletDynamics/ConstraintSolver/btSolverBody.h>

#include <array>

#include "plugins/bodies/impulse_rows.h"

namespace weir {

class MassRoot {
 public:
  /// Zero of what does not move, and along and about locked axes.
  explicit MassRoot(const btSolverBody& body);

  /// (J·L) of a row that has these for J.
  Vec6d jacobian(const btVector3& linear, const btVector3& angular) const;
  /// The velocities L·w.
  btVector3 linear(const Vec6d& w) const;
  btVector3 angular(const Vec6d& w) const;

 private:
  btVector3 linear_{0, 0, 0};
  btMatrix3x3 angular_{0, 0, 0, 0, 0, 0, 0, 0, 0};  // lower triangle
};

}  // namespace weir
