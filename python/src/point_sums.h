// Sums over the particles near points in space, on the host.
//
// f(x) = Σ V·W·f_i / Σ V·W with the kernel W(r) = 315/(64π·H³)·(1 − r²/H²)³ (Müller et al. 2003) of H = 2
// spacings, as the node Gauge has it; Σ V·W alone is 1 within fluid, and 1/2 at a flat surface.
#pragma once

#include <cstdint>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "framework/base/vec.h"

namespace weir::python {

class PointSums {
 public:
  /// `volumes` are one for each position, or one for all; m³. The spans must outlive this.
  PointSums(std::span<const Vec3f> positions, std::span<const float> volumes, float spacing);

  /// Σ V·W at each point.
  std::vector<float> filled(std::span<const Vec3f> points) const;
  /// The mean of each particle's T at each point; NaN where there is no particle.
  template <class T>
  std::vector<T> mean(std::span<const Vec3f> points, std::span<const T> values) const;

 private:
  using Cell = std::uint64_t;
  Cell cellOf(std::int64_t x, std::int64_t y, std::int64_t z) const;
  std::int64_t along(float coordinate) const;
  /// Calls f(i, V·W) for all particles i nearer to the point than H, in a fixed order.
  template <class F>
  void forEachNear(const Vec3f& point, const F& f) const;

  std::span<const Vec3f> positions_;
  std::span<const float> volumes_;
  double reach_;                                         // H, m
  std::vector<int> order_;                               // of the particles, by cell
  std::unordered_map<Cell, std::pair<int, int>> cells_;  // where a cell begins and ends there
};

}  // namespace weir::python
