// The thickness of a liquid, found on a compute device: its particles add their volume to the texels that
// they cover.
#pragma once

#include <algorithm>
#include <cstdint>

#include "framework/base/vec.h"
#include "framework/compute/array.h"
#include "plugins/rendering/gl/splat_kernels.h"

namespace weir::rendering::gl {

/// What a sum of thickness is made of.
struct ThicknessView {
  Vec3f rows[4];     ///< of the matrix from world to clip space
  float moved[4];    ///< its last column
  float texels = 0;  ///< of 1 m at a distance of 1 m
  float near = 0;    ///< particles before it are left out, m
  int width = 0, height = 0;
  float unit = 0;  ///< m that a sum of 1 means

  /// So fine that small shares of a particle count, so coarse that a million of them fit into a sum.
  void setUnitFor(float radius) { unit = std::max(unit, radius / 2048); }
};

/// Between what a liquid is seen. Of the sun, which sees all of it, both arrays are empty.
struct LiquidBetween {
  ArrayView<const std::uint32_t> front;  ///< bits of its depths in [0, 1], at each sample; see kFoamDepth
  ArrayView<const float> background;     ///< distance of what is opaque, at each texel, m
  int width = 0, height = 0;
  Vec4f projection;       ///< P00, P11, P22, P23
  float depthOfFoam = 0;  ///< in radii
};

/// Adds the way through spheres of a liquid and that through its foam, whose part in [0, 1] is what
/// SplatSphere::color holds, to `sums`, two numbers a texel. `chord`: ParticleView::chord().
template <class Backend>
void addLiquid(Backend& device, ArrayView<const SplatSphere> spheres, float chord, const ThicknessView& view,
               const LiquidBetween& between, ArrayView<std::uint32_t> sums);

/// In metres.
template <class Backend>
void thicknessOf(Backend& device, ArrayView<const std::uint32_t> sums, float unit,
                 ArrayView<Vec2f> thickness);

}  // namespace weir::rendering::gl
