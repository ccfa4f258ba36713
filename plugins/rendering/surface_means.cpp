#include "plugins/rendering/surface_means.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "framework/base/check.h"

namespace weir::rendering {

namespace {

/// Particles sorted by cells of a grid, the cells along x one behind the other.
class Cells {
 public:
  Cells(std::span<const Vec3f> positions, float side) : side_(side) {
    entries_.reserve(positions.size());
    for (std::size_t i = 0; i < positions.size(); ++i)
      if (isFinite(positions[i])) entries_.emplace_back(keyOf(cellOf(positions[i])), i);
    std::sort(entries_.begin(), entries_.end());
  }

  /// Calls `visit` with the numbers of the particles in the cells around a place.
  template <class F>
  void around(const Vec3f& place, const F& visit) const {
    const Cell cell = cellOf(place);
    for (std::int64_t z = -1; z <= 1; ++z)
      for (std::int64_t y = -1; y <= 1; ++y) {
        const std::uint64_t first = keyOf({cell.x - 1, cell.y + y, cell.z + z});
        const auto begin = std::lower_bound(entries_.begin(), entries_.end(), Entry{first, 0});
        for (auto entry = begin; entry != entries_.end() && entry->first <= first + 2; ++entry)
          visit(entry->second);
      }
  }

 private:
  using Entry = std::pair<std::uint64_t, std::size_t>;
  struct Cell {
    std::int64_t x, y, z;
  };

  Cell cellOf(const Vec3f& p) const {
    const auto along = [this](float c) {
      constexpr double kFarthest = 1 << 20;  // cells: what is farther shares the last one
      return static_cast<std::int64_t>(
          std::clamp(std::floor(static_cast<double>(c) / side_), 2 - kFarthest, kFarthest - 2));
    };
    return {along(p.x), along(p.y), along(p.z)};
  }
  static std::uint64_t keyOf(const Cell& cell) {
    constexpr int kBits = 21;
    const auto part = [](std::int64_t c) { return static_cast<std::uint64_t>(c + (1 << 20)); };
    return part(cell.z) << (2 * kBits) | part(cell.y) << kBits | part(cell.x);
  }

  float side_;
  std::vector<Entry> entries_;
};

}  // namespace

std::vector<Vec3f> meansAt(std::span<const Vec3f> places, std::span<const Vec3f> positions,
                           std::span<const Vec3f> vectors, float radius) {
  WEIR_CHECK(radius > 0);
  WEIR_CHECK(positions.size() == vectors.size());
  const Cells cells(positions, radius);
  std::vector<Vec3f> means(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (!isFinite(places[i])) continue;
    Vec3f sum;
    float weights = 0;
    cells.around(places[i], [&](std::size_t k) {
      const Vec3f away = positions[k] - places[i];
      const float left = 1 - dot(away, away) / (radius * radius);
      if (!(left > 0) || !isFinite(vectors[k])) return;
      sum += (left * left) * vectors[k];
      weights += left * left;
    });
    if (weights > 0) means[i] = (1 / weights) * sum;
  }
  return means;
}

}  // namespace weir::rendering
