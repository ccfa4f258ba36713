// Finds the particles around places on the host.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "framework/base/vec.h"

namespace weir::rendering {

/// Of particles at these positions, which must outlive it; what is not finite is left out.
class NearParticles {
 public:
  /// `radius`: m, above 0.
  NearParticles(std::span<const Vec3f> positions, float radius);

  /// Calls visit(k, w) with the number of each particle nearer than the radius and its weight
  /// w = (1 - r^2/radius^2)^2, above 0.
  template <class F>
  void visit(const Vec3f& place, const F& visit) const {
    if (!isFinite(place)) return;
    for (int row = 0; row < 9; ++row) {
      const std::uint64_t first = startOfRow(place, row);
      auto entry = std::lower_bound(entries_.begin(), entries_.end(), Entry{first, 0});
      for (; entry != entries_.end() && entry->first <= first + 2; ++entry) {
        const Vec3f away = positions_[entry->second] - place;
        const float left = 1 - dot(away, away) / (radius_ * radius_);
        if (left > 0) visit(entry->second, left * left);
      }
    }
  }

  std::size_t size() const { return positions_.size(); }
  float radius() const { return radius_; }

 private:
  /// By the cell of a particle, and its number.
  using Entry = std::pair<std::uint64_t, std::size_t>;

  /// The first of three cells along x, in one of the nine rows around a place.
  std::uint64_t startOfRow(const Vec3f& place, int row) const;

  std::span<const Vec3f> positions_;
  float radius_;
  std::vector<Entry> entries_;  // sorted: the cells along x are one behind the other
};

}  // namespace weir::rendering
