#include "plugins/views/near_particles.h"

#include <cmath>

#include "framework/base/check.h"

namespace weir::rendering {

namespace {

struct Cell {
  std::int64_t x, y, z;
};

Cell cellOf(const Vec3f& p, float side) {
  const auto along = [side](float c) {
    constexpr double kMax = 1 << 20;  // cells: what is farther shares the last one
    return static_cast<std::int64_t>(
        std::clamp(std::floor(static_cast<double>(c) / side), 2 - kMax, kMax - 2));
  };
  return {along(p.x), along(p.y), along(p.z)};
}

std::uint64_t keyOf(const Cell& cell) {
  constexpr int kBits = 21;
  const auto part = [](std::int64_t c) { return static_cast<std::uint64_t>(c + (1 << 20)); };
  return part(cell.z) << (2 * kBits) | part(cell.y) << kBits | part(cell.x);
}

}  // namespace

NearParticles::NearParticles(std::span<const Vec3f> positions, float radius)
    : positions_(positions), radius_(radius) {
  WEIR_CHECK(radius > 0);
  entries_.reserve(positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i)
    if (isFinite(positions[i])) entries_.emplace_back(keyOf(cellOf(positions[i], radius)), i);
  std::sort(entries_.begin(), entries_.end());
}

std::uint64_t NearParticles::startOfRow(const Vec3f& place, int row) const {
  const Cell cell = cellOf(place, radius_);
  return keyOf({cell.x - 1, cell.y + row % 3 - 1, cell.z + row / 3 - 1});
}

}  // namespace weir::rendering
