// The end of a body's step.
#pragma once

#include "framework/solids/free_body.h"

namespace weir {

/// Brings a body to where forces have led it in a step of `dt` s, whether or not a fluid has placed it; walls
/// and other bodies have not acted yet.
WEIR_HD inline void moveOn(FreeBody& b, const Vec3d& gravity, double dt) {
  b.before = b.state;
  if (!b.placed) {
    b.predicted = flown(b.mass, b.state, gravity, dt, b.applied);
    b.displacement = {};
    b.received = {};
  }
  const SolidImpulse taken = b.mass.taken(b.received);
  b.state = b.predicted.moved(b.displacement);
  b.state.velocity += taken.linear / b.mass.mass;
  b.state.spin += taken.angular;
  b.placed = 0;
  b.displacement = b.searched = b.change = {};
  b.motion = twistOf(b.mass, b.state);
  b.received = {};
}

}  // namespace weir
