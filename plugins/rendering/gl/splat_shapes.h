// What the kernels that splat spheres share: which samples a sphere covers, where a ray meets it, and in
// which order spheres come.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

#include "framework/base/vec.h"
#include "framework/compute/lanes.h"

namespace weir::rendering::gl {

inline constexpr std::uint32_t kOneBits = 0x3f800000;  // of 1.0f

/// Numbers that are not negative keep their order as bits.
WEIR_HD inline std::uint32_t bitsOf(float depth) {
  return std::bit_cast<std::uint32_t>(depth > 0 ? depth : 0.0f);
}

WEIR_HD inline int clampToInt(float x, int low, int high) {
  return x > float(low) ? (x < float(high) ? int(x) : high) : low;
}

/// First and last of the samples in a row or column whose middles lie between two places in clip space; none
/// if the first is behind the last.
struct Samples {
  int first, last;

  WEIR_HD static Samples between(float low, float high, int count) {
    constexpr float kSlack = 0.01f;  // of a sample, for rounding
    const float half = 0.5f * float(count);
    return {clampToInt(std::ceil((low + 1) * half - 0.5f - kSlack), 0, count),
            clampToInt(std::floor((high + 1) * half - 0.5f + kSlack), -1, count - 1)};
  }
};

/// Where the lines through the eye touch a circle in the plane of an axis and the viewing axis (M. Mara, M.
/// McGuire 2013): the exact bound of a sphere's picture along that axis.
WEIR_HD inline Samples touched(float across, float along, float radius, float tangent, int count) {
  const float touch = std::sqrt(across * across + along * along - radius * radius);
  return Samples::between((across * touch - along * radius) / (along * touch + across * radius) / tangent,
                          (across * touch + along * radius) / (along * touch - across * radius) / tangent,
                          count);
}

/// The order in which spheres are offered: in small groups from all over the fluid, because many of those
/// that come late are then found to be hidden before they are looked at closely. Fluids are sorted in space,
/// so without this, each layer might hide the one before it. Few spheres are shared row by row among several
/// calls, so that all threads have work.
struct Shares {
  static constexpr std::int64_t kGroup = 32;  // neighbours in memory
  std::int64_t spheres, groups, stride;
  int parts;

  explicit Shares(std::int64_t count)
      : spheres(count),
        groups((count + kGroup - 1) / kGroup),
        // Steps through all groups, since a prime that does not divide their number shares no factor with it.
        stride(groups % 7919 != 0 ? 7919 : 7907),
        parts(count < 65536 ? 8 : 1) {}

  std::int64_t count() const { return groups * kGroup * parts; }
  /// May be behind the last sphere.
  WEIR_HD std::int64_t sphere(std::int64_t k) const {
    const std::int64_t place = k / parts;
    return place / kGroup * stride % groups * kGroup + place % kGroup;
  }
  WEIR_HD int part(std::int64_t k) const { return static_cast<int>(k % parts); }
};

/// Where a ray meets a sphere: the distance along the camera's axis, and by how much the square of the radius
/// exceeds that of the ray's distance from the centre, negative for a miss. Of one number or of several.
template <class N>
struct Hit {
  N distance, rest;

  WEIR_HD Hit(const Vec3<N>& ray, const Vec3<N>& center, const N& radius) {
    const N scale = 1 / dot(ray, ray);
    const N middle = dot(ray, center) * scale;
    const Vec3<N> aside = ray * middle - center;
    rest = radius * radius - dot(aside, aside);
    distance = middle - sqrtf(positivePart(rest) * scale);
  }
};

}  // namespace weir::rendering::gl
