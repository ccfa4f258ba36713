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
WEIR_HD inline WhiteKind kindOf(float filled) {
  constexpr float kAbove = 0.15f, kBelow = 0.85f;
  return filled < kAbove ? WhiteKind::kSpray : filled < kBelow ? WhiteKind::kFoam : WhiteKind::kBubble;
}

struct WhiteParticles {
  ArrayView<Vec3f> positions, velocities;  // m, m/s
  ArrayView<int> kinds;
  ArrayView<float> ages, lifetimes;  // s; what has no lifetime left is dead
};

}  // namespace weir
