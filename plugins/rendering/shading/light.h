// The light of a picture, in numbers that are the same for all samples: for shaders and for kernels.
#pragma once

#include "framework/base/vec.h"

namespace weir::rendering {

inline constexpr int kShadowResolution = 1536;  ///< texels along a side of the shadow map

/// Directions are unit vectors in camera space, colours are linear.
struct ShadedLight {
  Vec3f sun, up;             ///< towards them
  Vec3f sunColor;            ///< of its light
  Vec3f sky, ground;         ///< colours of what is above and below
  Vec3f skyAbove, skyBelow;  ///< light from there
  Vec3f background[2];       ///< bottom and top
  float shadowTexel = 0;     ///< m; 0: there are no shadows
  float softness = 0;        ///< radius of the edges of shadows, in the shadow map's coordinates
  bool unlit = false;
};

/// Of ambient occlusion.
struct ShadedOcclusion {
  float radius = 0;        ///< m
  float radiusInView = 0;  ///< of 1 m at a distance of 1 m, in samples
  float largest = 0;       ///< samples; farther taps say little, and fetch from all over the memory
};

}  // namespace weir::rendering
