// What particles do to a body that forces move.
#pragma once

#include "framework/solids/free_body.h"

namespace weir {

/// Sums over the particles that meet one body.
struct BodySums {
  static constexpr int kOfPart = 6;
  Twist push;  ///< what they do: along each component of its motion
  /// By how much that falls as the body gives way, as TwistMatrix::of: in floats, since blocks of a GPU have
  /// no room for more, and since it only says how far the body goes in an iteration.
  float grip[TwistMatrix::kNumbers] = {};

  /// A push of that size along `direction` at `arm` m from the centre of mass, which falls by `gripOf` times
  /// the way that the body goes along the direction there.
  WEIR_HD void add(const Vec3d& direction, const Vec3d& arm, double size, double gripOf) {
    push += size * Twist{direction, cross(arm, direction)};
    if (!(gripOf > 0)) return;
    TwistMatrix added;
    added.addForce(gripOf, direction, arm);
    for (int k = 0; k < TwistMatrix::kNumbers; ++k) grip[k] += float(added.of[k]);
  }

  /// The numbers in parts of six: the push, then four of the grip's, the last one with zeros behind.
  static constexpr int kParts = 5;
  WEIR_HD Twist part(int k) const {
    if (k == 0) return push;
    double of[kOfPart] = {};
    for (int n = 0; n < kOfPart; ++n) {
      const int at = kOfPart * (k - 1) + n;
      if (at < TwistMatrix::kNumbers) of[n] = double(grip[at]);
    }
    return {{of[0], of[1], of[2]}, {of[3], of[4], of[5]}};
  }
  void setPart(int k, const Twist& to) {
    if (k == 0) push = to;
    const double of[] = {to.linear.x, to.linear.y, to.linear.z, to.angular.x, to.angular.y, to.angular.z};
    for (int n = 0; n < kOfPart && k > 0; ++n) {
      const int at = kOfPart * (k - 1) + n;
      if (at < TwistMatrix::kNumbers) grip[at] = float(of[n]);
    }
  }

  WEIR_HD void addGripTo(TwistMatrix& matrix) const {
    for (int k = 0; k < TwistMatrix::kNumbers; ++k) matrix.of[k] += double(grip[k]);
  }
};

struct AddBodySums {
  WEIR_HD BodySums operator()(BodySums a, const BodySums& b) const {
    a.push += b.push;
    for (int k = 0; k < TwistMatrix::kNumbers; ++k) a.grip[k] += b.grip[k];
    return a;
  }
};

}  // namespace weir
