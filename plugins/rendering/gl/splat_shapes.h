// What the kernels that splat spheres share: which samples a sphere covers, and in which order spheres come.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

#include "framework/base/vec.h"
#include "plugins/rendering/shading/formulas.h"

namespace weir::rendering::gl {

inline constexpr std::uint32_t kOneBits = 0x3f800000;  // of 1.0f

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

/// The samples along an axis that a sphere may cover.
WEIR_HD inline Samples touched(float across, float along, float radius, float tangent, int count) {
  const Vec2f lines = shading::touchingLines(across, along, radius);
  return Samples::between(lines.x / tangent, lines.y / tangent, count);
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

}  // namespace weir::rendering::gl
