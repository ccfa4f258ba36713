#include "python/src/point_sums.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

namespace weir::python {

namespace {

constexpr double kReach = 2;  // H, spacings

Vec3d wide(const Vec3f& v) {
  return {v.x, v.y, v.z};
}
double wide(float v) {
  return v;
}
void narrow(const Vec3d& v, Vec3f& to) {
  to = {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}
void narrow(double v, float& to) {
  to = static_cast<float>(v);
}

}  // namespace

PointSums::PointSums(std::span<const Vec3f> positions, std::span<const float> volumes, float spacing)
    : positions_(positions), volumes_(volumes), reach_(kReach * double(spacing)), order_(positions.size()) {
  std::vector<Cell> cells;
  cells.reserve(positions.size());
  for (const Vec3f& p : positions) cells.push_back(cellOf(along(p.x), along(p.y), along(p.z)));
  std::iota(order_.begin(), order_.end(), 0);
  const auto cell = [&](int i) { return cells[static_cast<std::size_t>(i)]; };
  std::ranges::stable_sort(order_, {}, cell);
  for (std::size_t begin = 0, end = 0; begin < order_.size(); begin = end) {
    while (end < order_.size() && cell(order_[end]) == cell(order_[begin])) ++end;
    cells_[cell(order_[begin])] = {static_cast<int>(begin), static_cast<int>(end)};
  }
}

std::int64_t PointSums::along(float coordinate) const {
  constexpr double kFar = 1e15;  // of cells; nothing is near what is farther away
  return static_cast<std::int64_t>(std::floor(std::clamp(double(coordinate) / reach_, -kFar, kFar)));
}

/// Far cells may share a number: what is not near adds nothing.
PointSums::Cell PointSums::cellOf(std::int64_t x, std::int64_t y, std::int64_t z) const {
  constexpr int kBits = 21;
  constexpr Cell kMask = (Cell{1} << kBits) - 1;
  return (static_cast<Cell>(x) & kMask) | (static_cast<Cell>(y) & kMask) << kBits |
         (static_cast<Cell>(z) & kMask) << (2 * kBits);
}

template <class F>
void PointSums::forEachNear(const Vec3f& point, const F& f) const {
  const double h2 = reach_ * reach_, scale = 315 / (64 * std::numbers::pi * h2 * reach_);
  const std::int64_t x = along(point.x), y = along(point.y), z = along(point.z);
  for (int neighbor = 0; neighbor < 27; ++neighbor) {
    const auto cell =
        cells_.find(cellOf(x + neighbor % 3 - 1, y + neighbor / 3 % 3 - 1, z + neighbor / 9 - 1));
    if (cell == cells_.end()) continue;
    for (int k = cell->second.first; k < cell->second.second; ++k) {
      const auto i = static_cast<std::size_t>(order_[static_cast<std::size_t>(k)]);
      const Vec3d away = wide(positions_[i]) - wide(point);
      const double rest = 1 - dot(away, away) / h2;
      if (rest > 0) f(i, double(volumes_[volumes_.size() > 1 ? i : 0]) * scale * rest * rest * rest);
    }
  }
}

std::vector<float> PointSums::filled(std::span<const Vec3f> points) const {
  std::vector<float> all;
  all.reserve(points.size());
  for (const Vec3f& point : points) {
    double sum = 0;
    forEachNear(point, [&](std::size_t, double weight) { sum += weight; });
    all.push_back(static_cast<float>(sum));
  }
  return all;
}

template <class T>
std::vector<T> PointSums::mean(std::span<const Vec3f> points, std::span<const T> values) const {
  std::vector<T> all(points.size());
  for (std::size_t k = 0; k < points.size(); ++k) {
    double weights = 0;
    decltype(wide(T{})) sum{};
    forEachNear(points[k], [&](std::size_t i, double weight) {
      weights += weight;
      sum = sum + weight * wide(values[i]);
    });
    const double share = weights > 0 ? 1 / weights : std::numeric_limits<double>::quiet_NaN();
    narrow(share * sum, all[k]);
  }
  return all;
}

template std::vector<float> PointSums::mean(std::span<const Vec3f>, std::span<const float>) const;
template std::vector<Vec3f> PointSums::mean(std::span<const Vec3f>, std::span<const Vec3f>) const;

}  // namespace weir::python
