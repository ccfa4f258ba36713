#include "plugins/bodies/impulse_rows.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace weir {

namespace {

/// Two sums, which do not wait for each other.
inline double dot(const Six& a, const Six& b) {
  const double even = a[0] * b[0] + a[2] * b[2] + a[4] * b[4];
  const double odd = a[1] * b[1] + a[3] * b[3] + a[5] * b[5];
  return even + odd;
}

inline double dot(const Pull& a, const Pull& b) {
  return dot(a.a, b.a) + dot(a.b, b.b);
}

inline void add(Six& to, double times, const Six& b) {
  for (std::size_t k = 0; k < 6; ++k) to[k] += times * b[k];
}

/// Two bodies' velocities, and what a row does to them.
struct Pair {
  Six &a, &b;

  Pair(Changes& changes, BodyPair of) : a(changes[of.a]), b(changes[of.b]) {}
  double along(const Pull& pull) const { return dot(pull.a, a) + dot(pull.b, b); }
  void push(const Pull& pull, double impulse) {
    add(a, impulse, pull.a);
    add(b, impulse, pull.b);
  }
};

/// What a sweep has changed.
struct Changed {
  double largest = 0;  ///< of a relative velocity
  double energy = 0;   ///< Σ Δλ²·G·Gᵀ

  void add(double impulse, double mobility) {
    largest = std::max(largest, std::abs(impulse) * mobility);
    energy += impulse * impulse * mobility;
  }
};

/// Goes on by a share of the way of the last sweep. Returns where it was.
inline double advance(double& impulse, double& previous, double momentum) {
  const double last = impulse;
  impulse += momentum * (last - previous);
  previous = last;
  return impulse;
}

inline void apply(ImpulseRow& row, Changes& changes, double momentum, Changed& changed) {
  Pair pair(changes, row.bodies);
  const double from = advance(row.impulse, row.previous, momentum);
  const double lack = row.wanted - row.softness * from - pair.along(row.pull);
  row.impulse = std::min(std::max(from + lack * row.inverse, row.lower), row.upper);
  const double more = row.impulse - from;
  pair.push(row.pull, more);
  changed.add(more, row.mobility);
}

inline void apply(FrictionRows& row, double normal, Changes& changes, double momentum, Changed& changed) {
  // A contact that does nothing, as most do in a pile.
  if (normal == 0 && row.impulse[0] == 0 && row.impulse[1] == 0 && row.previous[0] == 0 &&
      row.previous[1] == 0)
    return;
  Pair pair(changes, row.bodies);
  double from[2], lack[2], to[2];
  for (std::size_t k = 0; k < 2; ++k) {
    from[k] = advance(row.impulse[k], row.previous[k], momentum);
    lack[k] = row.wanted[k] - pair.along(row.pulls[k]);
  }
  to[0] = from[0] + row.inverse[0] * lack[0] + row.inverse[1] * lack[1];
  to[1] = from[1] + row.inverse[1] * lack[0] + row.inverse[2] * lack[1];
  const double bound = row.friction * normal;
  if (to[0] * to[0] + to[1] * to[1] > bound * bound) {
    for (std::size_t k = 0; k < 2; ++k) to[k] = from[k] + row.step * lack[k];
    const double length = std::sqrt(to[0] * to[0] + to[1] * to[1]);
    const double share = length > bound ? bound / length : 1;
    for (double& x : to) x *= share;
  }
  for (std::size_t k = 0; k < 2; ++k) {
    row.impulse[k] = to[k];
    pair.push(row.pulls[k], to[k] - from[k]);
    changed.add(to[k] - from[k], row.mobility);
  }
}

Changed sweepOnce(ImpulseRows& rows, Changes& changes, double momentum) {
  Changed changed;
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

void advance(Changes& changes, Changes& previous, double momentum) {
  for (std::size_t body = 0; body < changes.size(); ++body)
    for (std::size_t k = 0; k < 6; ++k) advance(changes[body][k], previous[body][k], momentum);
}

/// Impulses before the first sweep have no way behind them.
void stand(ImpulseRows& rows) {
  for (auto* some : {&rows.joints, &rows.contacts})
    for (ImpulseRow& row : *some) row.previous = row.impulse;
  for (FrictionRows& row : rows.frictions) row.previous = row.impulse;
}

double inverseOf(double x) {
  return x > 0 ? 1 / x : 0;
}

}  // namespace

ImpulseRow rowOf(const Pull& pull, BodyPair bodies, double softness) {
  ImpulseRow row;
  row.pull = pull;
  row.bodies = bodies;
  row.softness = softness;
  row.mobility = dot(pull, pull);
  row.inverse = inverseOf(row.mobility + softness);
  return row;
}

FrictionRows frictionOf(const std::array<Pull, 2>& pulls, BodyPair bodies) {
  FrictionRows rows;
  rows.pulls = pulls;
  rows.bodies = bodies;
  const double xx = dot(pulls[0], pulls[0]), xy = dot(pulls[0], pulls[1]), yy = dot(pulls[1], pulls[1]);
  const double half = (xx - yy) / 2;
  rows.mobility = (xx + yy) / 2 + std::sqrt(half * half + xy * xy);
  rows.step = inverseOf(rows.mobility);
  const double determinant = xx * yy - xy * xy;
  constexpr double kSingular = 1e-12;  // of the product: one direction cannot move
  if (determinant > kSingular * rows.mobility * rows.mobility)
    rows.inverse[0] = yy / determinant, rows.inverse[1] = -xy / determinant,
    rows.inverse[2] = xx / determinant;
  else
    rows.inverse[0] = rows.inverse[2] = rows.step;
  return rows;
}

void applyImpulses(const ImpulseRows& rows, Changes& changes) {
  for (const auto* some : {&rows.joints, &rows.contacts})
    for (const ImpulseRow& row : *some) Pair(changes, row.bodies).push(row.pull, row.impulse);
  for (const FrictionRows& row : rows.frictions)
    for (std::size_t k = 0; k < 2; ++k) Pair(changes, row.bodies).push(row.pulls[k], row.impulse[k]);
}

int sweep(ImpulseRows& rows, Changes& changes, const SweepsEnd& end) {
  stand(rows);
  Changes previous = changes;
  Momentum momentum;
  double share = 0;
  for (int k = 0; k < end.maxSweeps; ++k) {
    advance(changes, previous, share);
    const Changed changed = sweepOnce(rows, changes, share);
    if (changed.largest <= end.tolerance) return k + 1;
    share = momentum.next(changed.energy);
  }
  return end.maxSweeps;
}

}  // namespace weir
