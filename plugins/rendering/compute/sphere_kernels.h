// From particles to the spheres of a picture, on a compute device.
#pragma once

#include <cstdint>

#include "framework/base/vec.h"
#include "framework/compute/array.h"

namespace weir::rendering {

struct SplatSphere {
  Vec3f center;      ///< m
  float radius = 0;  ///< m; 0 where the centre is not finite, and then it is not seen
  /// Red in the lowest byte, then green, blue and the material; of a liquid, the bits of the part of foam.
  std::uint32_t color = 0;
};

/// How numbers become colours: places among texels, of which the first 256 are a colour map. Between two of
/// them is a mixture.
struct ColorEntries {
  static constexpr int kCount = 258, kFixed = 256, kUnknown = 257;  ///< the last ones: no number, and NaN

  float lowest = 0, highest = 1;  ///< values at the ends of the map

  WEIR_HD float of(float value) const {
    if (!(value == value)) return kUnknown;
    const float range = highest - lowest;
    float t = value > lowest ? 1.0f : (value == lowest ? 0.5f : 0.0f);
    if (range > 0) t = (value - lowest) / range;
    return 255 * (t > 0 ? (t < 1 ? t : 1.0f) : 0.0f);
  }
};

struct SphereColors {
  ArrayView<const std::uint32_t> texels;  ///< packed colours; none: the values are parts of foam
  ColorEntries entries;
  float radius = 0;  ///< m, of all spheres
};

/// Makes spheres of particles. `values` may be empty: then all have the fixed colour, or no foam.
template <class Backend>
void packSpheres(Backend& device, ArrayView<const Vec3f> positions, ArrayView<const float> values,
                 const SphereColors& colors, ArrayView<SplatSphere> spheres);

}  // namespace weir::rendering
