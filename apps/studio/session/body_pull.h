// A hand that pulls a body of a running simulation, as by a spring between its centre of mass and the hand.
#pragma once

#include <optional>
#include <string>

#include "framework/base/vec.h"
#include "framework/run/simulation.h"

namespace weir::studio {

/// A body, by its node, and where its centre of mass is wanted, m.
struct BodyWish {
  std::string node;
  Vec3f to;
};

/// Throws a usage Error if there is no body that can be pulled by this name: one with a force that is applied
/// to it, and not given by keyframes.
void requirePullable(const Scene& scene, const std::string& node);

/// Besides the force that the scene applies, the body of mass m at x with velocity v gets
///   f = m·(ω²·(to - x) - 2·ω·v),  ω = min(30 1/s, 1/(2·dt)),
/// a spring that is critically damped, softer where steps are long, but no more than m·100 m/s². Of a
/// simulation's thread, between its steps.
class BodyPull {
 public:
  /// Pulls this body from now on, and no other one.
  void pull(Simulation& simulation, BodyWish wish);
  /// Takes the force from where the body is now; does nothing where none is pulled. Waits for the device.
  void update(Simulation& simulation);
  /// The body has the scene's force alone again.
  void release(Simulation& simulation);
  /// Its simulation is gone.
  void forget() { wish_.reset(); }

 private:
  std::optional<BodyWish> wish_;
  Vec3f ofScene_;  // N
};

}  // namespace weir::studio
