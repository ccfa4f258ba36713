// Lights what splat_kernels.h found, without OpenGL: ground, ambient occlusion, a sun with a soft shadow,
// lines, tone curve. The arithmetic is that of the shaders of the passes in gl/, and so are the numbers'
// formats.
#pragma once

#include <cstdint>

#include "framework/base/vec.h"
#include "framework/compute/array.h"
#include "plugins/rendering/gl/splat_kernels.h"

namespace weir::rendering {

/// The ground: a level disc, seen from above only. In camera space.
struct ShadedGround {
  bool visible = false;
  Vec3f middle, up;
  float radius = 0;          ///< m
  std::uint32_t albedo = 0;  ///< with its material
};

struct ShadedOcclusion {
  float radius = 0;        ///< m
  float radiusInView = 0;  ///< of 1 m at a distance of 1 m, in samples
  float largest = 0;       ///< samples
};

/// A line in the picture: a rectangle, in samples. Depth changes from one short side to the other.
struct ShadedLine {
  Vec2f from, along;  ///< the middle of a short side, and the unit vector to the other one
  float length = 0, halfWidth = 0;
  float depth = 0, depthStep = 0;  ///< at the first side, and its change a sample
  Vec3f color;                     ///< linear
  float opacity = 1;
};

struct ShadedLight {
  Vec3f sun, up;                   ///< unit vectors in camera space
  Vec3f sky, ground;               ///< light from above and below
  Vec3f background[2];             ///< bottom and top
  Vec3f toShadow[3], shadowMoved;  ///< from camera space to the shadow map
  float shadowTexel = 0;           ///< m
  float softness = 0;              ///< in the map's coordinates
  int shadowResolution = 0;        ///< texels along a side; 0: there are no shadows
  bool unlit = false;
};

struct ShadedPicture {
  gl::SplatCamera camera;  ///< in samples
  int samples = 1;         ///< per axis and pixel
  int width = 0, height = 0;
  ShadedLight light;
  ShadedGround ground;
  ArrayView<const float> linear;  ///< of each sRGB number of eight bits
  ArrayView<const ShadedLine> lines;
  ArrayView<const std::uint32_t> albedo, normal;  ///< see gl::SplatTexels
  ArrayView<const float> depth;
  ArrayView<const std::uint32_t> shadow;  ///< bits of depths
  ArrayView<const std::uint8_t> open;     ///< occlusion of each pixel, 255 is open; rows from the bottom
};

/// Puts the ground behind what is there.
template <class Backend>
void addGround(Backend& device, const gl::SplatCamera& camera, const ShadedGround& ground,
               const gl::SplatTexels& texels);

/// Fills `open`; `scratch` has its size.
template <class Backend>
void findOcclusion(Backend& device, const ShadedPicture& picture, const ShadedOcclusion& occlusion,
                   ArrayView<std::uint8_t> open, ArrayView<std::uint8_t> scratch);

/// Writes red, green and blue of each pixel, the upper row first.
template <class Backend>
void shade(Backend& device, const ShadedPicture& picture, ArrayView<std::uint8_t> rgb);

}  // namespace weir::rendering
