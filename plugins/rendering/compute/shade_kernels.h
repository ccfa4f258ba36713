// Lights what splat_kernels.h found, without OpenGL: ground, ambient occlusion, a sun with a soft shadow,
// lines, tone curve.
#pragma once

#include <cstddef>
#include <cstdint>

#include "framework/base/vec.h"
#include "framework/compute/array.h"
#include "plugins/rendering/compute/seen_samples.h"
#include "plugins/rendering/compute/shadow_tiles.h"
#include "plugins/rendering/shading/light.h"

namespace weir::rendering {

/// More lines are OpenGL's: each pixel looks at all of them.
inline constexpr std::size_t kMaxLines = 256;

/// A line in the picture: a rectangle, in samples. Depth changes from one short side to the other.
struct ShadedLine {
  Vec2f from, along;  ///< the middle of a short side, and the unit vector to the other one
  float length = 0, halfWidth = 0;
  float depth = 0, depthStep = 0;  ///< at the first side, and its change a sample
  float lowest = 0, highest = 0;   ///< the rows that it touches
  Vec3f color;                     ///< linear
  float opacity = 1;
};

/// Where points are in the shadow map.
struct ShadowMap {
  gl::AffineMap toMap;  ///< from camera space to its coordinates
  int resolution = 0;   ///< texels along a side; 0: there are no shadows
};

struct ShadedPicture {
  SeenSamples seen;
  int samples = 1;  ///< per axis and pixel
  int width = 0, height = 0;
  ShadedLight light;
  ShadowMap shadowMap;
  ArrayView<const float> linear;  ///< of each sRGB number of eight bits
  ArrayView<const ShadedLine> lines;
  ArrayView<const float> shadow;  ///< depths
  ShadowTiles tiles;
  ArrayView<const float>
      open;  ///< of each pixel, 1 where nothing occludes; rows from the bottom. May be empty.
};

/// Makes a picture for gl::splatDepths that shows the ground alone.
template <class Backend>
void showGround(Backend& device, const SeenSamples& seen, ArrayView<std::uint64_t> nearest);

/// Writes red, green and blue of each pixel, the upper row first.
template <class Backend>
void shade(Backend& device, const ShadedPicture& picture, ArrayView<std::uint8_t> rgb);

}  // namespace weir::rendering
