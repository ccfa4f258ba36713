// What the particles of a fluid have where its surface is: velocities for motion blur, and colours.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "framework/base/vec.h"

namespace weir::rendering {

/// Of particles at these positions, which must outlive it; what is not finite is left out.
class SurfaceMeans {
 public:
  /// `radius`: m, above 0.
  SurfaceMeans(std::span<const Vec3f> positions, float radius);

  /// Of each place (m), the mean of the vectors, one for each particle, of those within the radius, with
  /// weights (1 - r^2/radius^2)^2; zero where there is none, or the place is not finite.
  std::vector<Vec3f> at(std::span<const Vec3f> places, std::span<const Vec3f> vectors) const;

 private:
  /// By the cell of a particle, and its number.
  using Entry = std::pair<std::uint64_t, std::size_t>;

  std::span<const Vec3f> positions_;
  float radius_;
  std::vector<Entry> entries_;  // sorted: the cells along x are one behind the other
};

}  // namespace weir::rendering
