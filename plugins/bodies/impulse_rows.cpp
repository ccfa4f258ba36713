#include "plugins/bodies/impulse_rows.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace weir {

namespace {

/// Two sums, which do not wait for each other.
inline double dot(const Vec6d& a, const Vec6d& b) {
  const double even = a[0] * b[0] + a[2] * b[2] + a[4] * b[4];
  const double odd = a[1] * b[1] + a[3] * b[3] + a[5] * b[5];
  return even + odd;
}

inline double dot(const ScaledJacobian& a, const ScaledJacobian& b) {
  return dot(a.a, b.a) + dot(a.b, b.b);
}

inline void add(Vec6d& to, double times, const Vec6d& b) {
  for (std::size_t k = 0; k < 6; ++k) to[k] += times * b[k];
}

/// Two bodies' velocities, and what a row does to them.
struct PairVelocities {
  Vec6d &a, &b;

  PairVelocities(VelocityChanges& changes, BodyPair of) : a(changes[of.a]), b(changes[of.b]) {}
  double relative(const ScaledJacobian& jacobian) const { return dot(jacobian.a, a) + dot(jacobian.b, b); }
  void applyImpulse(const ScaledJacobian& jacobian, double impulse) {
    add(a, impulse, jacobian.a);
    add(b, impulse, jacobian.b);
  }
};

/// What a sweep has changed.
struct SweepChange {
  double largest = 0;  ///< of a relative velocity
  double energy = 0;   ///< Σ Δλ²·G·Gᵀ

  void add(double impulse, double inverseMass) {
    largest = std::max(largest, std::abs(impulse) * inverseMass);
    energy += impulse * impulse * inverseMass;
  }
};

/// Adds a share of what the last sweep changed. Returns the result.
inline double extrapolate(double& impulse, double& previous, double momentum) {
  const double last = impulse;
  impulse += momentum * (last - previous);
  previous = last;
  return impulse;
}

inline void apply(ImpulseRow& row, VelocityChanges& changes, double momentum, SweepChange& changed) {
  PairVelocities velocities(changes, row.bodies);
  const double before = extrapolate(row.impulse, row.previous, momentum);
  const double residual = row.target - row.softness * before - velocities.relative(row.jacobian);
  row.impulse = std::min(std::max(before + residual * row.effectiveMass, row.lower), row.upper);
  const double delta = row.impulse - before;
  velocities.applyImpulse(row.jacobian, delta);
  changed.add(delta, row.inverseMass);
}

inline void apply(FrictionRows& row, double normal, VelocityChanges& changes, double momentum,
                  SweepChange& changed) {
  // A contact that does nothing, as most do in a pile.
  if (normal == 0 && row.impulse[0] == 0 && row.impulse[1] == 0 && row.previous[0] == 0 &&
      row.previous[1] == 0)
    return;
  PairVelocities velocities(changes, row.bodies);
  double before[2], residual[2], after[2];
  for (std::size_t k = 0; k < 2; ++k) {
    before[k] = extrapolate(row.impulse[k], row.previous[k], momentum);
    residual[k] = row.target[k] - velocities.relative(row.jacobians[k]);
  }
  after[0] = before[0] + row.effectiveMass[0] * residual[0] + row.effectiveMass[1] * residual[1];
  after[1] = before[1] + row.effectiveMass[1] * residual[0] + row.effectiveMass[2] * residual[1];
  const double bound = row.friction * normal;
  if (after[0] * after[0] + after[1] * after[1] > bound * bound) {
    for (std::size_t k = 0; k < 2; ++k) after[k] = before[k] + row.step * residual[k];
    const double length = std::sqrt(after[0] * after[0] + after[1] * after[1]);
    const double share = length > bound ? bound / length : 1;
    for (double& x : after) x *= share;
  }
  for (std::size_t k = 0; k < 2; ++k) {
    row.impulse[k] = after[k];
    velocities.applyImpulse(row.jacobians[k], after[k] - before[k]);
    changed.add(after[k] - before[k], row.inverseMass);
  }
}

SweepChange sweepOnce(ImpulseRows& rows, VelocityChanges& changes, double momentum) {
  SweepChange changed;
  for (ImpulseRow& joint : rows.joints) apply(joint, changes, momentum, changed);
  for (ImpulseRow& contact : rows.contacts) apply(contact, changes, momentum, changed);
  for (FrictionRows& friction : rows.frictions)
    apply(friction, rows.contacts[friction.contact].impulse, changes, momentum, changed);
  return changed;
}

/// The share of the last sweep's way by which the next one begins farther: Nesterov's, from none to all.
class Momentum {
 public:
  double next(double energy) {
    if (energy > last_) t_ = 1;
    last_ = energy;
    const double before = t_;
    t_ = (1 + std::sqrt(1 + 4 * t_ * t_)) / 2;
    return (before - 1) / t_;
  }

 private:
  double t_ = 1, last_ = std::numeric_limits<double>::infinity();
};

void extrapolate(VelocityChanges& changes, VelocityChanges& previous, double momentum) {
  for (std::size_t body = 0; body < changes.size(); ++body)
    for (std::size_t k = 0; k < 6; ++k) extrapolate(changes[body][k], previous[body][k], momentum);
}

/// Impulses before the first sweep have no sweep behind them.
void clearMomentum(ImpulseRows& rows) {
  for (auto* some : {&rows.joints, &rows.contacts})
    for (ImpulseRow& row : *some) row.previous = row.impulse;
  for (FrictionRows& row : rows.frictions) row.previous = row.impulse;
}

double inverseOf(double x) {
  return x > 0 ? 1 / x : 0;
}

}  // namespace

ImpulseRow makeRow(const ScaledJacobian& jacobian, BodyPair bodies, double softness) {
  ImpulseRow row;
  row.jacobian = jacobian;
  row.bodies = bodies;
  row.softness = softness;
  row.inverseMass = dot(jacobian, jacobian);
  row.effectiveMass = inverseOf(row.inverseMass + softness);
  return row;
}

FrictionRows makeFriction(const std::array<ScaledJacobian, 2>& jacobians, BodyPair bodies) {
  FrictionRows rows;
  rows.jacobians = jacobians;
  rows.bodies = bodies;
  const double xx = dot(jacobians[0], jacobians[0]), xy = dot(jacobians[0], jacobians[1]),
               yy = dot(jacobians[1], jacobians[1]);
  const double half = (xx - yy) / 2;
  rows.inverseMass = (xx + yy) / 2 + std::sqrt(half * half + xy * xy);
  rows.step = inverseOf(rows.inverseMass);
  const double determinant = xx * yy - xy * xy;
  constexpr double kSingular = 1e-12;  // of the product: one direction cannot move
  if (determinant > kSingular * rows.inverseMass * rows.inverseMass)
    rows.effectiveMass[0] = yy / determinant, rows.effectiveMass[1] = -xy / determinant,
    rows.effectiveMass[2] = xx / determinant;
  else
    rows.effectiveMass[0] = rows.effectiveMass[2] = rows.step;
  return rows;
}

void applyImpulses(const ImpulseRows& rows, VelocityChanges& changes) {
  for (const auto* some : {&rows.joints, &rows.contacts})
    for (const ImpulseRow& row : *some)
      PairVelocities(changes, row.bodies).applyImpulse(row.jacobian, row.impulse);
  for (const FrictionRows& row : rows.frictions)
    for (std::size_t k = 0; k < 2; ++k)
      PairVelocities(changes, row.bodies).applyImpulse(row.jacobians[k], row.impulse[k]);
}

int sweep(ImpulseRows& rows, VelocityChanges& changes, const SweepLimits& end) {
  clearMomentum(rows);
  VelocityChanges previous = changes;
  Momentum momentum;
  double share = 0;
  for (int k = 0; k < end.maxSweeps; ++k) {
    extrapolate(changes, previous, share);
    const SweepChange changed = sweepOnce(rows, changes, share);
    if (changed.largest <= end.tolerance) return k + 1;
    share = momentum.next(changed.energy);
  }
  return end.maxSweeps;
}

}  // namespace weir
