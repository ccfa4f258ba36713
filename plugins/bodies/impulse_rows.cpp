#include "plugins/bodies/impulse_rows.h"

#include <algorithm>
#include <cmath>

namespace weir {

namespace {

/// Two sums, which do not wait for each other.
inline double dot(const Six& a, const Six& b) {
  const double even = a[0] * b[0] + a[2] * b[2] + a[4] * b[4];
  const double odd = a[1] * b[1] + a[3] * b[3] + a[5] * b[5];
  return even + odd;
}

inline void add(Six& to, double times, const Six& b) {
  for (std::size_t k = 0; k < 6; ++k) to[k] += times * b[k];
}

/// Returns by how much it changes the relative velocity of its bodies.
inline double apply(ImpulseRow& row, Changes& changes) {
  Six &a = changes[row.a], &b = changes[row.b];
  const double speed = dot(row.directionA, a) + dot(row.directionB, b);
  const double wanted = row.impulse + (row.wanted - row.softness * row.impulse - speed * row.inverse);
  const double impulse = std::min(std::max(wanted, row.lower), row.upper);
  const double more = impulse - row.impulse;
  if (more == 0) return 0;
  row.impulse = impulse;
  add(a, more, row.changeA);
  add(b, more, row.changeB);
  return std::abs(more) * row.mobility;
}

double sweepOnce(std::vector<ImpulseRow>& joints, std::vector<ImpulseRow>& contacts,
                 std::vector<FrictionRow>& frictions, Changes& changes) {
  double largest = 0;
  for (ImpulseRow& joint : joints) largest = std::max(largest, apply(joint, changes));
  for (ImpulseRow& contact : contacts) largest = std::max(largest, apply(contact, changes));
  for (auto& [row, friction, contact] : frictions) {
    const double bound = friction * contacts[contact].impulse;
    if (!(contacts[contact].impulse > 0)) continue;
    row.lower = -bound;
    row.upper = bound;
    largest = std::max(largest, apply(row, changes));
  }
  return largest;
}

void applyImpulse(const ImpulseRow& row, Changes& changes) {
  add(changes[row.a], row.impulse, row.changeA);
  add(changes[row.b], row.impulse, row.changeB);
}

}  // namespace

void applyImpulses(const std::vector<ImpulseRow>& contacts, const std::vector<FrictionRow>& frictions,
                   Changes& changes) {
  for (const ImpulseRow& row : contacts) applyImpulse(row, changes);
  for (const FrictionRow& friction : frictions) applyImpulse(friction.row, changes);
}

void sweep(std::vector<ImpulseRow>& joints, std::vector<ImpulseRow>& contacts,
           std::vector<FrictionRow>& frictions, Changes& changes, const SweepsEnd& end) {
  for (int k = 0; k < end.maxSweeps; ++k)
    if (sweepOnce(joints, contacts, frictions, changes) <= end.tolerance) return;
}

}  // namespace weir
