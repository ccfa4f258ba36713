// From which side particles see the triangles of a solid.
#pragma once

#include "framework/base/vec.h"
#include "framework/compute/lanes.h"

namespace weir {

enum SeenSide : int { kSeesFront = 1, kSeesBack = 2 };

/// The sides of a triangle that p may be on: both where rounding hides which. Mask is what comparisons of T
/// give.
template <class Mask>
struct SidesOf {
  Mask front, back;
};

template <class T>
WEIR_HD auto sidesOf(const Vec3<T>& p, const Vec3<T>& a, const Vec3<T>& b, const Vec3<T>& c) {
  constexpr float kRounding = 1e-5f;  // far above that of the cross product of floats
  const Vec3<T> normal = cross(b - a, c - a), arm = p - a;
  const T height = dot(arm, normal);
  const T min = kRounding * sqrtf(dot(arm, arm) * dot(normal, normal));
  return SidesOf<decltype(height < min)>{!(height < -min), !(height > min)};
}

WEIR_HD inline int sidesSeen(const Vec3f& p, const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  const auto sides = sidesOf(p, a, b, c);
  return (sides.front ? kSeesFront : 0) | (sides.back ? kSeesBack : 0);
}

}  // namespace weir
