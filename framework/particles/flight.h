// How long something may fly freely before it has gone a given way: what limits the time steps of particles.
#pragma once

#include <cmath>
#include <limits>

namespace weir {

/// The time dt, in s, after which speed·dt + acceleration·dt² = distance: how far a particle of that speed
/// gets at most in a step that begins with a push of acceleration·dt, as the prediction does. All in SI
/// units and not negative; infinite if it never gets there.
inline double timeToFly(double distance, double speed, double acceleration) {
  // The usual root of the quadratic equation, in a form without cancellation.
  const double denominator = speed + std::sqrt(speed * speed + 4 * acceleration * distance);
  return denominator > 0 ? 2 * distance / denominator : std::numeric_limits<double>::infinity();
}

}  // namespace weir
