#include "plugins/rendering/compute/sphere_kernels.h"

#include <bit>
#include <cmath>

#include "framework/compute/parallel.h"

namespace weir::rendering {

namespace {

struct PackSphere {
  ArrayView<const Vec3f> positions;
  ArrayView<const float> values;
  SphereColors colors;
  ArrayView<SplatSphere> spheres;

  /// The mixture of two neighbouring texels, byte by byte.
  WEIR_HD std::uint32_t colorAt(float entry) const {
    const int last = static_cast<int>(colors.texels.size) - 2;
    const int first = entry < static_cast<float>(last) ? static_cast<int>(entry) : last;
    const float part = entry - static_cast<float>(first);
    const std::uint32_t a = colors.texels[first], b = colors.texels[first + 1];
    std::uint32_t color = a & 0xff000000u;
    for (int shift = 0; shift < 24; shift += 8) {
      const auto from = static_cast<float>(a >> shift & 255u), to = static_cast<float>(b >> shift & 255u);
      color |= static_cast<std::uint32_t>(from + (to - from) * part + 0.5f) << shift;
    }
    return color;
  }

  WEIR_HD std::uint32_t colorOf(std::int64_t i) const {
    if (colors.texels.size == 0) return std::bit_cast<std::uint32_t>(values.size > 0 ? values[i] : 0.0f);
    return colorAt(values.size > 0 ? colors.entries.of(values[i]) : ColorEntries::kFixed);
  }

  WEIR_HD void operator()(std::int64_t i) const {
    const Vec3f p = positions[i];
    spheres[i] = {p, isFinite(p) ? colors.radius : 0.0f, colorOf(i)};
  }
};

}  // namespace

template <class Backend>
void packSpheres(Backend& device, ArrayView<const Vec3f> positions, ArrayView<const float> values,
                 const SphereColors& colors, ArrayView<SplatSphere> spheres) {
  parallelFor(device, "pack spheres", positions.size, PackSphere{positions, values, colors, spheres});
}

template void packSpheres(ThisBackend&, ArrayView<const Vec3f>, ArrayView<const float>, const SphereColors&,
                          ArrayView<SplatSphere>);

}  // namespace weir::rendering
