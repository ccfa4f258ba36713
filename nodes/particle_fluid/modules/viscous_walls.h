// How walls hold viscous fluid: as if the fluid went on behind them, with velocities that go linearly through
// that of the wall. Over the half-space behind a plane at a distance of h, with c(r) = 2(d + 2)·|W'|/r,
//
//   β(h) = ∫ c(r)·(x̂·t)²·z/h dV,   t along the wall, z how far from the particle the plane through dV is
//
// is a drag ν·β on the velocity along the wall, relative to it. A wall's slip, from 0 to 1, takes that share
// away; at 1 there is no drag. The sum of β·h over the layers of settled fluid is made that of the integral,
// so shear stress passes into the wall as it passes through the fluid.
//
// Pairs near walls weigh more. A wall with slip is a mirror: the pairs that end behind it would resist shear
// along it too. At a wall without, fluid lies in layers that are further from each other than particles
// within it, with few pairs across (gapFactor).
#pragma once

#include <algorithm>

#include "framework/compute/eight.h"
#include "nodes/static_boundary/boundary.h"

namespace weir {

/// β·H² at h = q·H, q above 0; for the spiky kernel.
template <class T>
WEIR_HD T planeDrag(T q) {
  if (!(q < 1)) return 0;
  const T q2 = q * q, q3 = q2 * q;
  const T sum = T(1) / 30 - T(2) / 3 * q2 + T(8) / 3 * q3 - q2 * q2 * (T(3) / 2 - 2 * std::log(q)) -
                T(8) / 15 * q2 * q3;
  return T(112.5) * (sum > 0 ? sum : 0) / q;
}

/// What is behind a plane at q·H of ∫ c(r)·r²·(x̂·t)²·(x̂·s)² dV, t and s at right angles along the plane; for
/// the spiky kernel, and as a share of the whole.
template <class T>
WEIR_HD T shearBehind(T q) {
  if (!(q < 1)) return 0;
  if (!(q > 0)) return T(0.5);
  const T q2 = q * q, q3 = q2 * q, q5 = q2 * q3, near = 1 - q;
  const T sum = T(1) / 120 - q2 * q2 / 8 + q5 / 5 - q3 * q3 / 12 -
                T(15) / 16 * q * (T(1) / 30 - q3 / 3 + q2 * q2 / 2 - q5 / 5) +
                T(5) / 24 * q3 * near * near * near - T(3) / 16 * q5 * (1 / q + 2 * std::log(q) - q);
  return sum > 0 ? 60 * sum : 0;
}

/// The share of the kernel behind it.
WEIR_HD inline float kernelBehind(float q) {
  const float near = positivePart(1 - q), square = near * near;
  return 0.5f * square * square * near * (1 + 2 * q);
}

/// How much more a pair of settled fluid weighs, for each such share of its particles, such that films flow
/// as Nusselt's at support ratios from 1.5 to 2.5 (ViscositySolver.AFilm… in the tests).
inline float gapFactor(double supportRatio) {
  return static_cast<float>(std::clamp(4 * supportRatio - 2, 0.0, 6.0));
}

/// What makes the sum over layers, one spacing apart from `first` on, that of the integral; all in spacings.
inline double layerFactor(double supportRatio, double first) {
  double sum = 0;
  for (double h = first; h < supportRatio; ++h) sum += planeDrag(h / supportRatio) * h;
  return supportRatio * supportRatio / std::max(sum, 1e-3);
}

/// h/H of a plane behind which there is the share `behind` of the kernel.
WEIR_HD inline float planeOf(float behind) {
  constexpr int kBisections = 20;
  float low = 0, high = 1;
  for (int k = 0; k < kBisections; ++k) {
    const float q = 0.5f * (low + high);
    (kernelBehind(q) > behind ? low : high) = q;
  }
  return high;
}

/// Σ B over the walls of each particle, B = dt·ν·β·(1 − slip)·(1 − n·nᵀ), by its diagonal and the rest (yz,
/// zx, xy); and Σ B·v of the walls. Empty where no wall drags.
struct WallDrag {
  ArrayView<Vec3f> diagonal, rest, push;

  WEIR_HD bool empty() const { return diagonal.size == 0; }
  WEIR_HD void add(std::int64_t i, float strength, const Vec3f& n, const Vec3f& velocity) const {
    diagonal[i] += strength * Vec3f{1 - n.x * n.x, 1 - n.y * n.y, 1 - n.z * n.z};
    rest[i] -= strength * Vec3f{n.y * n.z, n.z * n.x, n.x * n.y};
    push[i] += strength * (velocity - dot(velocity, n) * n);
  }
  /// Σ B·u.
  template <class Index, class T>
  WEIR_HD Vec3<T> operator()(Index i, const Vec3<T>& u) const {
    const auto d = read(diagonal, i), r = read(rest, i);
    return {d.x * u.x + r.z * u.y + r.y * u.z, r.z * u.x + d.y * u.y + r.x * u.z,
            r.y * u.x + r.x * u.y + d.z * u.z};
  }
};

}  // namespace weir
