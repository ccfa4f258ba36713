// From particles to the spheres of a picture, on a compute device.
#pragma once

#include <cstdint>

#include "framework/base/vec.h"
#include "framework/compute/array.h"

namespace weir::rendering {

struct SplatSphere {
  Vec3f center;             ///< m
  float radius = 0;         ///< m; 0 where the centre is not finite, and then it is not seen
  std::uint32_t color = 0;  ///< red in the lowest byte, then green, blue and the material
};

/// How numbers become colours, see gl::ParticleColors.
struct SphereColors {
  ArrayView<const std::uint32_t> texels;  ///< packed colours
  float lowest = 0, highest = 1;          ///< values at the ends of the map
  float radius = 0;                       ///< m, of all spheres
};

/// Makes spheres of particles. `values` may be empty: then all have the fixed colour.
template <class Backend>
void packSpheres(Backend& device, ArrayView<const Vec3f> positions, ArrayView<const float> values,
                 const SphereColors& colors, ArrayView<SplatSphere> spheres);

/// The box around all finite positions, in device memory.
template <class Backend>
void boxOf(Backend& device, ArrayView<const Vec3f> positions, Aabb* box);

}  // namespace weir::rendering
