// The places at which pictures take samples of light, for shaders and for kernels: all in the unit circle.
#pragma once

#include "framework/base/vec.h"

namespace weir::rendering {

/// Where the shadow map is looked at: four of a sunflower's seeds, which are evenly spread (H. Vogel 1979),
/// and by which cosine and sine each of four neighbouring samples turns them, so that a pixel of 2 x 2
/// samples sees sixteen places.
struct ShadowPattern {
  static constexpr int kTaps = 4, kTurns = 4;
  Vec2f taps[kTaps], turns[kTurns];
};
ShadowPattern shadowPattern();

/// Where ambient occlusion looks around: a spiral of seven turns, a number without a factor in common with
/// that of the taps, and the turns of the pixels of a square of four by four.
struct OcclusionPattern {
  static constexpr int kTaps = 11, kTurns = 16;
  Vec2f taps[kTaps], turns[kTurns];
};
OcclusionPattern occlusionPattern();

}  // namespace weir::rendering
