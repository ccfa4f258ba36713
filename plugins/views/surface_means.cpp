#include "plugins/views/surface_means.h"

#include <algorithm>
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

/// Calls `visit` with the numbers of the particles in the cells around one.
template <class Entries, class F>
void forEachAround(const Entries& entries, const Cell& cell, const F& visit) {
  for (std::int64_t z = -1; z <= 1; ++z)
    for (std::int64_t y = -1; y <= 1; ++y) {
      const std::uint64_t first = keyOf({cell.x - 1, cell.y + y, cell.z + z});
      const auto isBefore = [](const auto& entry, std::uint64_t key) { return entry.first < key; };
      auto entry = std::lower_bound(entries.begin(), entries.end(), first, isBefore);
      for (; entry != entries.end() && entry->first <= first + 2; ++entry) visit(entry->second);
    }
}

}  // namespace

SurfaceMeans::SurfaceMeans(std::span<const Vec3f> positions, float radius)
    : positions_(positions), radius_(radius) {
  WEIR_CHECK(radius > 0);
  entries_.reserve(positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i)
    if (isFinite(positions[i])) entries_.emplace_back(keyOf(cellOf(positions[i], radius)), i);
  std::sort(entries_.begin(), entries_.end());
}

std::vector<Vec3f> SurfaceMeans::at(std::span<const Vec3f> places, std::span<const Vec3f> vectors) const {
  WEIR_CHECK(vectors.size() == positions_.size());
  std::vector<Vec3f> means(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (!isFinite(places[i])) continue;
    Vec3f sum;
    float weights = 0;
    forEachAround(entries_, cellOf(places[i], radius_), [&](std::size_t k) {
      const Vec3f away = positions_[k] - places[i];
      const float left = 1 - dot(away, away) / (radius_ * radius_);
      if (!(left > 0) || !isFinite(vectors[k])) return;
      sum += (left * left) * vectors[k];
      weights += left * left;
    });
    if (weights > 0) means[i] = (1 / weights) * sum;
  }
  return means;
}

}  // namespace weir::rendering
