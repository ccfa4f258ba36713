// Which sphere is seen at each sample of a picture, found on a compute device: every sphere offers its depth
// to the samples that it covers, and the nearest stays.
#pragma once

#include <cstdint>

#include "framework/base/vec.h"
#include "framework/compute/array.h"
#include "plugins/rendering/compute/sphere_kernels.h"
#include "plugins/rendering/shading/formulas.h"

namespace weir::rendering::gl {

struct AffineMap {
  Vec3f rows[3];  ///< of its matrix
  Vec3f moved;    ///< its last column

  template <class N>
  WEIR_HD Vec3<N> point(const Vec3<N>& p) const {
    return {along(rows[0], p) + moved.x, along(rows[1], p) + moved.y, along(rows[2], p) + moved.z};
  }
  template <class N>
  WEIR_HD static N along(const Vec3f& row, const Vec3<N>& p) {
    return dot(Vec3<N>{N(row.x), N(row.y), N(row.z)}, p);
  }
};

/// A camera as the shaders know it.
struct SplatCamera {
  AffineMap view;             ///< from world to camera space
  Vec2f tangent;              ///< of half the field of view
  Vec4f projection;           ///< P00, P11, P22, P23
  float near = 0;             ///< m
  int width = 0, height = 0;  ///< samples

  template <class N>
  WEIR_HD N depthAt(const N& distance) const {
    return shading::depthOf(distance, projection);
  }
  /// The ray through the middle of a sample.
  template <class N>
  WEIR_HD auto ray(const N& x, const N& y) const {
    return shading::rayThrough(x + 0.5f, y + 0.5f, Vec2f{2.0f / float(width), 2.0f / float(height)}, tangent);
  }
};

/// The sun's parallel projection onto a square of texels.
struct SplatSun {
  AffineMap toClip;    ///< from world to clip space
  float halfSize = 1;  ///< m
  float zToDepth = 1;  ///< clip depth of 1 m
  int resolution = 0;  ///< texels along a side
};

/// What is seen at each sample, row by row from the bottom, in the formats of Targets. Samples that no sphere
/// covers have colour 0, depth 1 and the normal towards the eye.
struct SplatTexels {
  ArrayView<std::uint32_t> albedo;  ///< GL_RGBA, GL_UNSIGNED_BYTE
  ArrayView<std::uint32_t> normal;  ///< GL_RG, GL_UNSIGNED_SHORT; see shading::storedNormal
  ArrayView<std::uint32_t> depthBits;
};

/// The number of samples at which no sphere is seen, in the lower half of splatDepths' `nearest`. Spheres
/// count down from the number below it, so that of spheres that are equally near, the last one is seen.
inline constexpr std::uint32_t kNoSphere = 0xffffffff;

/// Puts spheres before what `nearest` holds for each sample: the bits of a depth in its upper half, a number
/// in its lower half.
template <class Backend>
void splatDepths(Backend& device, ArrayView<const SplatSphere> spheres, const SplatCamera& camera,
                 ArrayView<std::uint64_t> nearest);

/// `nearest` is scratch of width × height elements.
template <class Backend>
void splatGeometry(Backend& device, ArrayView<const SplatSphere> spheres, const SplatCamera& camera,
                   ArrayView<std::uint64_t> nearest, const SplatTexels& out);

/// The bits of the farthest depth, 1.
template <class Backend>
void clearDepths(Backend& device, ArrayView<std::uint32_t> depthBits);

/// Puts spheres before the depths that are there. They are drawn back by `inset` (ParticleView::inset()).
template <class Backend>
void splatDepths(Backend& device, ArrayView<const SplatSphere> spheres, const SplatCamera& camera,
                 float inset, ArrayView<std::uint32_t> depthBits);

/// The same as the sun sees them, in clip space from 0 to 1.
template <class Backend>
void splatSunDepths(Backend& device, ArrayView<const SplatSphere> spheres, const SplatSun& sun,
                    ArrayView<std::uint32_t> depthBits);

}  // namespace weir::rendering::gl
