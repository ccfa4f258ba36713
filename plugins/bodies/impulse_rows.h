// Projected Gauss-Seidel for the rows of contacts and joints (Catto 2005, "Iterative dynamics with temporal
// coherence"): each row in turn gets the impulse that its residual asks for, within its bounds,
//
//   λ ← clamp(λ + (b − ε·λ − J·v)/(J·M⁻¹·Jᵀ + ε)),   v ← v + M⁻¹·Jᵀ·Δλ.
//
// With M⁻¹ = L·Lᵀ and v = L·w, a row needs only its scaled Jacobian G = J·L: J·v = G·w and w ← w + Gᵀ·Δλ.
// So rows take half the memory, from which they come in each sweep.
//
// Sweeps have momentum (Nesterov 1983), which begins anew whenever a sweep changes more than the one before
// it (O'Donoghue and Candès 2015): a load goes through a stack of n bodies in some n sweeps rather than n².
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace weir {

/// Linear and angular part.
using Vec6d = std::array<double, 6>;

/// G of two bodies.
struct ScaledJacobian {
  Vec6d a{}, b{};
};

/// Indices into the changes of the bodies' velocities.
struct BodyPair {
  std::uint32_t a = 0, b = 0;
};

struct ImpulseRow {
  ScaledJacobian jacobian;  ///< G
  BodyPair bodies;
  double inverseMass = 0;    ///< G·Gᵀ
  double effectiveMass = 0;  ///< 1/(G·Gᵀ + ε), 0 of what cannot move
  double target = 0;         ///< b, m/s
  double softness = 0;       ///< ε
  double lower = 0, upper = 0, impulse = 0;
  double previous = 0;  ///< the impulse one sweep ago
};

/// Friction in both directions of a contact's plane, by Coulomb: as long as it is below μ·N it stops its
/// bodies, and otherwise acts against the way they slide,
///
///   λ ← λ + A⁻¹·(b − J·v), and if that is longer than μ·N, λ ← μ·N·u/|u| with u = λ + (b − J·v)/ρ,
///
/// where A is J·M⁻¹·Jᵀ and ρ its larger eigenvalue.
struct FrictionRows {
  using Two = std::array<double, 2>;
  std::array<ScaledJacobian, 2> jacobians;
  BodyPair bodies;
  std::uint32_t contact = 0;            ///< its row
  double friction = 0;                  ///< μ
  double effectiveMass[3] = {0, 0, 0};  ///< A⁻¹: xx, xy, yy
  double step = 0, inverseMass = 0;     ///< 1/ρ, ρ
  Two target{}, impulse{}, previous{};
};

/// Changes of the bodies' velocities, w.
using VelocityChanges = std::vector<Vec6d>;

/// All rows of bodies that touch.
struct ImpulseRows {
  std::vector<ImpulseRow> joints, contacts;
  std::vector<FrictionRows> frictions;
};

/// With the masses of its Jacobian and softness.
ImpulseRow makeRow(const ScaledJacobian& jacobian, BodyPair bodies, double softness = 0);
FrictionRows makeFriction(const std::array<ScaledJacobian, 2>& jacobians, BodyPair bodies);

/// Adds what impulses do that rows have before they are swept.
void applyImpulses(const ImpulseRows& rows, VelocityChanges& changes);

/// Sweeps over the rows until none changes a velocity by more than the tolerance, at most maxSweeps
/// times. Returns how many it took.
struct SweepLimits {
  int maxSweeps = 0;
  double tolerance = 0;  ///< m/s or rad/s
};
int sweep(ImpulseRows& rows, VelocityChanges& changes, const SweepLimits& end);

}  // namespace weir
