// What white water is made of, as kernels see it.
#pragma once

#include <cstdint>

#include "framework/base/vec.h"
#include "framework/compute/array.h"

namespace weir {

/// The attribute "type".
enum class WhiteKind : int { kSpray = 0, kFoam = 1, kBubble = 2 };

/// By how much of the kernel around a particle the fluid fills, where there is no wall: half at a flat
/// surface, and these at half a spacing above and below it.
inline constexpr float kFilledAbove = 0.15f, kFilledBelow = 0.85f;
WEIR_HD inline WhiteKind kindOf(float filled) {
  if (filled < kFilledAbove) return WhiteKind::kSpray;
  return filled < kFilledBelow ? WhiteKind::kFoam : WhiteKind::kBubble;
}

/// How far below the surface that is, in half spacings.
WEIR_HD inline float depthOf(float filled) {
  return (2 * filled - 1) / (kFilledBelow - kFilledAbove);
}

struct WhiteParticles {
  ArrayView<Vec3f> positions, velocities;  // m, m/s
  ArrayView<int> kinds;
  ArrayView<float> ages, lifetimes;  // s; what has no lifetime left is dead
};

}  // namespace weir
