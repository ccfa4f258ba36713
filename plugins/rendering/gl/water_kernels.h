// The surface and the thickness of a liquid, found on a compute device: its particles offer their depths to
// the samples that they cover, and add their volume to the texels.
#pragma once

#include <cstdint>

#include "framework/base/vec.h"
#include "framework/compute/array.h"
#include "plugins/rendering/gl/splat_kernels.h"

namespace weir::rendering::gl {

struct WaterParticle {
  Vec3f center;      ///< m, finite
  float radius = 0;  ///< m
  float foam = 0;    ///< part, in [0, 1]
  float inset = 0;   ///< see insetOf(), m
  float chord = 0;   ///< way through its middle that has the particle's volume, m
};

/// What a sum of thickness is made of.
struct ThicknessView {
  Vec3f rows[4];     ///< of the matrix from world to clip space
  float moved[4];    ///< its last column
  float texels = 0;  ///< of 1 m at a distance of 1 m
  float near = 0;    ///< particles before it are left out, m
  int width = 0, height = 0;
  float unit = 1;  ///< m that a sum of 1 means
};

/// Between what a liquid is seen. Of the sun, which sees all of it, both arrays are empty.
struct LiquidBetween {
  ArrayView<const std::uint32_t> front;  ///< bits of its depths in [0, 1], at each sample; see kFoamDepth
  ArrayView<const float> background;     ///< distance of what is opaque, at each texel, m
  int width = 0, height = 0;
  Vec4f projection;       ///< P00, P11, P22, P23
  float depthOfFoam = 0;  ///< in radii
};

/// Bits of the least depth at each sample, row by row from the bottom; those of 1 where there is nothing.
template <class Backend>
void splatWaterDepth(Backend& device, ArrayView<const WaterParticle> particles, const SplatCamera& camera,
                     ArrayView<std::uint32_t> depthBits);

/// The same for the sun.
template <class Backend>
void splatWaterSunDepth(Backend& device, ArrayView<const WaterParticle> particles, const SplatSun& sun,
                        ArrayView<std::uint32_t> depthBits);

/// The way through the liquid and that through foam at each texel, m. `sums` is scratch of two numbers a
/// texel.
template <class Backend>
void splatThickness(Backend& device, ArrayView<const WaterParticle> particles, const ThicknessView& view,
                    const LiquidBetween& between, ArrayView<std::uint32_t> sums, ArrayView<Vec2f> thickness);

}  // namespace weir::rendering::gl
