// A rigid body that forces move: its mass and its state, and the arithmetic of its motion. All of it stands
// on the device, so that no step waits for the host.
//
// The state holds the centre of mass c, its velocity v, the rotation R of the mesh and the angular momentum L
// about c. Between forces, with ω = (R·I·Rᵀ)⁻¹·L,
//
//   v ← v + dt·(g + F/m),   c ← c + dt·v,   dR/dt = ω × R,   L ← L + dt·T
//
// as particles of a fluid fly, so that a body falls with the water around it. F and T are what the user
// applies. R follows by Runge-Kutta's fourth-order method in steps of at most kLongestTurn; L is exact. What
// is held by a lock, a component of v or ω along an axis of the world, is 0, and so are its forces: whatever
// holds it takes them up.
#pragma once

#include <cmath>
#include <cstdint>

#include "framework/base/api.h"
#include "framework/base/vec.h"
#include "framework/geometry/mass_properties.h"
#include "framework/solids/pose.h"

namespace WEIR_API weir {

/// What fluids did to a solid: ∫ force dt [N·s] and ∫ torque dt [N·m·s], the latter about the solid's pivot.
struct SolidImpulse {
  Vec3d linear, angular;

  WEIR_HD SolidImpulse& operator+=(const SolidImpulse& b) {
    linear += b.linear;
    angular += b.angular;
    return *this;
  }
};

/// Unit quaternion w + xi + yj + zk.
struct Quatd {
  double w = 1, x = 0, y = 0, z = 0;
  friend bool operator==(const Quatd&, const Quatd&) = default;
};

WEIR_HD inline Vec3d rotate(const Quatd& q, const Vec3d& v) {
  const Vec3d u{q.x, q.y, q.z};
  const Vec3d t = 2.0 * cross(u, v);
  return v + q.w * t + cross(u, t);
}

WEIR_HD inline Quatd operator*(const Quatd& a, const Quatd& b) {
  return {a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
          a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
}

WEIR_HD inline Quatd normalized(const Quatd& q) {
  const double l = sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  return {q.w / l, q.x / l, q.y / l, q.z / l};
}

/// By |turn| rad about its direction.
WEIR_HD inline Quatd rotationBy(const Vec3d& turn) {
  const double angle = length(turn), half = 0.5 * angle;
  const double s = angle > 1e-8 ? sin(half) / angle : 0.5;
  return normalized({cos(half), s * turn.x, s * turn.y, s * turn.z});
}

WEIR_HD inline Vec3d doubleOf(const Vec3f& v) {
  return {v.x, v.y, v.z};
}
WEIR_HD inline Vec3f floatOf(const Vec3d& v) {
  return {float(v.x), float(v.y), float(v.z)};
}

/// R·S·Rᵀ.
WEIR_HD inline Symmetric3 rotated(const Quatd& q, const Symmetric3& s) {
  const Vec3d x = rotate(q, {1, 0, 0}), y = rotate(q, {0, 1, 0}), z = rotate(q, {0, 0, 1});
  const Vec3d sx = s.xx * x + s.xy * y + s.zx * z, sy = s.xy * x + s.yy * y + s.yz * z,
              sz = s.zx * x + s.yz * y + s.zz * z;
  const auto of = [&](int i, int j) { return sx[i] * x[j] + sy[i] * y[j] + sz[i] * z[j]; };
  return {of(0, 0), of(1, 1), of(2, 2), of(0, 1), of(1, 2), of(2, 0)};
}

/// Of the six components of a motion: those of the velocity of the centre of mass, then of the angular
/// velocity.
struct Twist {
  Vec3d linear;   ///< m/s or m
  Vec3d angular;  ///< rad/s or rad

  /// Of the body's point at `arm` m from the centre of mass.
  WEIR_HD Vec3d at(const Vec3d& arm) const { return linear + cross(angular, arm); }
  WEIR_HD Twist& operator+=(const Twist& b) {
    linear += b.linear;
    angular += b.angular;
    return *this;
  }
  friend WEIR_HD Twist operator-(const Twist& a, const Twist& b) {
    return {a.linear - b.linear, a.angular - b.angular};
  }
  friend WEIR_HD Twist operator*(double s, const Twist& a) { return {s * a.linear, s * a.angular}; }
};

/// A symmetric matrix for twists: its lower triangle, by rows.
struct TwistMatrix {
  static constexpr int kSize = 6, kNumbers = kSize * (kSize + 1) / 2;
  double of[kNumbers] = {};

  WEIR_HD double& at(int i, int j) { return of[i * (i + 1) / 2 + j]; }
  WEIR_HD double at(int i, int j) const { return of[i * (i + 1) / 2 + j]; }
  /// Adds w·a·aᵀ with a = (direction, arm × direction): what a force along the direction does there.
  WEIR_HD void addForce(double w, const Vec3d& direction, const Vec3d& arm) {
    const Vec3d moment = cross(arm, direction);
    const double a[kSize] = {direction.x, direction.y, direction.z, moment.x, moment.y, moment.z};
    for (int i = 0, k = 0; i < kSize; ++i)
      for (int j = 0; j <= i; ++j) of[k++] += w * a[i] * a[j];
  }
};

WEIR_HD inline Twist product(const TwistMatrix& a, const Twist& x) {
  const double from[6] = {x.linear.x, x.linear.y, x.linear.z, x.angular.x, x.angular.y, x.angular.z};
  double to[6] = {};
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) to[i] += (i > j ? a.at(i, j) : a.at(j, i)) * from[j];
  return {{to[0], to[1], to[2]}, {to[3], to[4], to[5]}};
}

/// x of A·x = b, where the components of x that `locked` has a bit for are 0, by Cholesky's method. A must be
/// positive definite without these.
WEIR_HD inline Twist solved(TwistMatrix a, const Twist& right, std::int64_t locked) {
  constexpr int kSize = TwistMatrix::kSize;
  double x[kSize] = {right.linear.x,  right.linear.y,  right.linear.z,
                     right.angular.x, right.angular.y, right.angular.z};
  for (int i = 0; i < kSize; ++i) {
    if ((locked >> i & 1) == 0) continue;
    for (int j = 0; j < kSize; ++j) (i > j ? a.at(i, j) : a.at(j, i)) = i == j ? 1 : 0;
    x[i] = 0;
  }
  for (int i = 0; i < kSize; ++i)
    for (int j = 0; j <= i; ++j) {
      double sum = a.at(i, j);
      for (int k = 0; k < j; ++k) sum -= a.at(i, k) * a.at(j, k);
      a.at(i, j) = i == j ? sqrt(sum) : sum / a.at(j, j);
    }
  for (int i = 0; i < kSize; ++i) {
    for (int k = 0; k < i; ++k) x[i] -= a.at(i, k) * x[k];
    x[i] /= a.at(i, i);
  }
  for (int i = kSize - 1; i >= 0; --i) {
    for (int k = i + 1; k < kSize; ++k) x[i] -= a.at(k, i) * x[k];
    x[i] /= a.at(i, i);
  }
  return {{x[0], x[1], x[2]}, {x[3], x[4], x[5]}};
}

struct BodyMass {
  double mass = 0;     ///< kg
  Vec3d center;        ///< m, in the frame of the mesh
  Symmetric3 inertia;  ///< kg·m², about the centre of mass, along the axes of the mesh
  /// A bit for each component of a Twist, along the axes of the world, that is held at 0. (As wide as it is,
  /// it leaves no gap whose bytes checkpoints would hold.)
  std::int64_t locked = 0;

  /// The matrix of mass and inertia along the axes of the world.
  WEIR_HD TwistMatrix matrix(const Quatd& rotation) const {
    const Symmetric3 i = rotated(rotation, inertia);
    TwistMatrix m;
    for (int k = 0; k < 3; ++k) m.at(k, k) = mass;
    m.at(3, 3) = i.xx, m.at(4, 4) = i.yy, m.at(5, 5) = i.zz;
    m.at(4, 3) = i.xy, m.at(5, 4) = i.yz, m.at(5, 3) = i.zx;
    return m;
  }
  /// What an impulse about the centre of mass changes of the motion; so the angular velocity of a momentum.
  WEIR_HD Twist motionOf(const SolidImpulse& impulse, const Quatd& rotation) const {
    return solved(matrix(rotation), {impulse.linear, impulse.angular}, locked);
  }
  /// Without what locks take up.
  WEIR_HD SolidImpulse taken(SolidImpulse impulse) const {
    for (int k = 0; k < 3; ++k) {
      if (locked >> k & 1) impulse.linear[k] = 0;
      if (locked >> (k + 3) & 1) impulse.angular[k] = 0;
    }
    return impulse;
  }
};

/// What a user does to a body: a force [N] at its centre of mass, and a torque [N·m], both along the axes of
/// the world.
struct AppliedForce {
  Vec3d force, torque;
  friend bool operator==(const AppliedForce&, const AppliedForce&) = default;
};

struct BodyState {
  Vec3d center;    ///< m
  Quatd rotation;  ///< of the mesh
  Vec3d velocity;  ///< m/s
  Vec3d spin;      ///< kg·m²/s: the angular momentum about the centre

  /// The same, with its centre and its rotation moved on.
  WEIR_HD BodyState moved(const Twist& way) const {
    BodyState to = *this;
    to.center += way.linear;
    to.rotation = normalized(rotationBy(way.angular) * rotation);
    return to;
  }
};

WEIR_HD inline Twist twistOf(const BodyMass& mass, const BodyState& state) {
  return {state.velocity, mass.motionOf({{}, state.spin}, state.rotation).angular};
}

WEIR_HD inline Pose poseOf(const BodyMass& mass, const BodyState& state) {
  const Quatd& q = state.rotation;
  return {{float(q.w), float(q.x), float(q.y), float(q.z)}, floatOf(state.center - rotate(q, mass.center))};
}

/// Turns for `dt` s without a torque.
WEIR_HD inline Quatd spun(const BodyMass& mass, Quatd q, const Vec3d& spin, double dt) {
  constexpr double kLongestTurn = 0.05;  // rad
  constexpr double kMostTurns = 1000;
  const auto rate = [&](const Quatd& at) { return mass.motionOf({{}, spin}, normalized(at)).angular; };
  const auto slope = [&](const Quatd& at) {
    const Vec3d w = rate(at);
    return Quatd{0, 0.5 * w.x, 0.5 * w.y, 0.5 * w.z} * at;
  };
  const auto along = [](const Quatd& a, double t, const Quatd& s) {
    return Quatd{a.w + t * s.w, a.x + t * s.x, a.y + t * s.y, a.z + t * s.z};
  };
  const double wanted = ceil(length(rate(q)) * dt / kLongestTurn);
  const int turns = wanted > 1 ? int(wanted < kMostTurns ? wanted : kMostTurns) : 1;
  const double h = dt / turns;
  for (int k = 0; k < turns; ++k) {
    const Quatd a = slope(q), b = slope(along(q, 0.5 * h, a)), c = slope(along(q, 0.5 * h, b)),
                d = slope(along(q, h, c));
    q = normalized(along(along(along(along(q, h / 6, a), h / 3, b), h / 3, c), h / 6, d));
  }
  return q;
}

/// Where a body is after `dt` s by gravity (m/s²) and what is applied alone.
WEIR_HD inline BodyState flown(const BodyMass& mass, BodyState state, const Vec3d& gravity, double dt,
                               const AppliedForce& applied = {}) {
  const SolidImpulse push = mass.taken({dt * (gravity + applied.force / mass.mass), dt * applied.torque});
  state.velocity += push.linear;
  state.spin += push.angular;
  state.center += dt * state.velocity;
  if (dot(state.spin, state.spin) > 0) state.rotation = spun(mass, state.rotation, state.spin, dt);
  return state;
}

struct FreeBody {
  BodyMass mass;
  BodyState state;  ///< between steps

  // Within a step, from where a fluid places the body until its node moves it on.
  std::int64_t placed = 0;  ///< whether a fluid has placed it in this step
  BodyState predicted;      ///< at the end of the step by gravity and what is applied alone
  Twist displacement;       ///< from there, by what the fluid's pressure does, as far as the solver has come
  Twist searched;           ///< the displacement at which the solids near particles were found
  Twist change;             ///< of the displacement, in this iteration
  Twist motion;             ///< its velocities, as far as they are known
  SolidImpulse received;    ///< from fluids, about the centre of mass

  BodyState before;      ///< at the beginning of the last step
  AppliedForce applied;  ///< by the user, in steps to come
};

}  // namespace weir
