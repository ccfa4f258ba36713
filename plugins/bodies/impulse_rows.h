// Projected Gauss-Seidel for the rows of contacts and joints (Catto 2005, "Iterative dynamics with temporal
// coherence"): each row in turn gets the impulse that its two bodies lack, within its bounds,
//
//   λ ← clamp(λ + (b − ε·λ − J·v)/(J·M⁻¹·Jᵀ)),   v ← v + M⁻¹·Jᵀ·Δλ.
//
// What a row needs stands together, for two bodies of six components each.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace weir {

/// Linear and angular, m/s and rad/s.
using Six = std::array<double, 6>;

struct ImpulseRow {
  Six directionA, directionB;  ///< J
  Six changeA, changeB;        ///< M⁻¹·Jᵀ; zero of what does not move
  double mobility = 0;         ///< J·M⁻¹·Jᵀ
  double inverse = 0;          ///< one over that
  double wanted = 0;           ///< b/mobility
  double softness = 0;         ///< ε/mobility
  double lower = 0, upper = 0, impulse = 0;
  std::size_t a = 0, b = 0;
};

/// Friction, bounded by the impulse of a contact: a row of index `contact`.
struct FrictionRow {
  ImpulseRow row;
  double friction = 0;
  std::size_t contact = 0;
};

/// Changes of the bodies' velocities.
using Changes = std::vector<Six>;

/// Adds what impulses do that rows have before they are swept.
void applyImpulses(const std::vector<ImpulseRow>& contacts, const std::vector<FrictionRow>& frictions,
                   Changes& changes);

/// Sweeps over the rows until none changes a velocity by more than the tolerance, at most maxSweeps
/// times.
struct SweepsEnd {
  int maxSweeps = 0;
  double tolerance = 0;  ///< m/s or rad/s
};
void sweep(std::vector<ImpulseRow>& joints, std::vector<ImpulseRow>& contacts,
           std::vector<FrictionRow>& frictions, Changes& changes, const SweepsEnd& end);

}  // namespace weir
