#include "framework/geometry/polygon.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <string>

#include "framework/base/error.h"

namespace weir {

namespace {

/// Cutting takes time with the square of it.
constexpr std::size_t kMaxConcaveCorners = 2000;

struct Point {
  double x, y;
};

/// Twice the area of a triangle, positive where it turns to the left.
double turn(const Point& a, const Point& b, const Point& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// The polygon's corners in the plane of two axes in which it is largest, counter-clockwise.
std::vector<Point> flattened(std::span<const int> corners, const std::vector<Vec3f>& vertices) {
  std::array<double, 3> normal{};  // by Newell's sum, which needs no corner to be special
  const auto at = [&](std::size_t i) { return vertices[static_cast<std::size_t>(corners[i])]; };
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec3f a = at(i), b = at((i + 1) % corners.size());
    for (int k = 0; k < 3; ++k) {
      const int u = (k + 1) % 3, v = (k + 2) % 3;
      normal[static_cast<std::size_t>(k)] += (double(a[u]) - double(b[u])) * (double(a[v]) + double(b[v]));
    }
  }
  int axis = 0;
  for (int k = 1; k < 3; ++k)
    if (std::abs(normal[static_cast<std::size_t>(k)]) > std::abs(normal[static_cast<std::size_t>(axis)]))
      axis = k;
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const double sign = normal[static_cast<std::size_t>(axis)] < 0 ? -1 : 1;
  std::vector<Point> points;
  points.reserve(corners.size());
  for (std::size_t i = 0; i < corners.size(); ++i)
    points.push_back({sign * double(at(i)[u]), double(at(i)[v])});
  return points;
}

/// Whether it turns to the left everywhere, and once around.
bool isConvex(const std::vector<Point>& points) {
  const std::size_t n = points.size();
  int changes = 0;
  double before = 0, first = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Point &a = points[i], &b = points[(i + 1) % n], &c = points[(i + 2) % n];
    if (turn(a, b, c) < 0) return false;
    const double step = b.x - a.x;
    if (step == 0) continue;
    if (first == 0) first = step;
    if (before * step < 0) ++changes;
    before = step;
  }
  return changes + (before * first < 0 ? 1 : 0) <= 2;
}

class EarCutter {
 public:
  explicit EarCutter(const std::vector<Point>& points)
      : points_(points), before_(points.size()), after_(points.size()), left_(points.size()) {
    std::iota(before_.begin() + 1, before_.end(), 0);
    before_[0] = points.size() - 1;
    std::iota(after_.begin(), after_.end(), 1);
    after_.back() = 0;
    tests_ = 4 * points.size() * points.size();
  }

  /// Calls add(a, b, c) for each triangle.
  template <class Add>
  void cut(Add&& add) {
    std::size_t corner = 0, failures = 0;
    while (left_ > 3) {
      // A polygon that crosses itself may have no ear: then any corner must do.
      if (failures < left_ && !isEar(corner)) {
        corner = after_[corner];
        ++failures;
        continue;
      }
      add(before_[corner], corner, after_[corner]);
      after_[before_[corner]] = after_[corner];
      before_[after_[corner]] = before_[corner];
      // The one after the next, so that triangles do not all meet at one corner.
      corner = after_[after_[corner]];
      failures = 0;
      --left_;
    }
    add(before_[corner], corner, after_[corner]);
  }

 private:
  bool isEar(std::size_t corner) {
    const Point &a = points_[before_[corner]], &b = points_[corner], &c = points_[after_[corner]];
    if (turn(a, b, c) <= 0) return false;
    for (std::size_t i = after_[after_[corner]]; i != before_[corner]; i = after_[i]) {
      if (tests_ == 0) return true;  // it must come to an end
      --tests_;
      const Point& p = points_[i];
      const bool inside = turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0;
      if (inside && !same(p, a) && !same(p, b) && !same(p, c)) return false;
    }
    return true;
  }
  /// Files cut holes in by a seam, whose two sides have the same corners.
  static bool same(const Point& a, const Point& b) { return a.x == b.x && a.y == b.y; }

  const std::vector<Point>& points_;
  std::vector<std::size_t> before_, after_;
  std::size_t left_, tests_;
};

}  // namespace

void addPolygon(std::span<const int> corners, const std::vector<Vec3f>& vertices,
                std::vector<Vec3i>& triangles) {
  const std::size_t n = corners.size();
  if (n < 3) return;
  const auto add = [&](std::size_t a, std::size_t b, std::size_t c) {
    triangles.push_back({corners[a], corners[b], corners[c]});
  };
  if (n == 3) return add(0, 1, 2);
  const std::vector<Point> points = flattened(corners, vertices);
  if (isConvex(points)) {
    for (std::size_t i = 2; i < n; ++i) add(0, i - 1, i);
    return;
  }
  if (n > kMaxConcaveCorners)
    throw ioError("a face has " + std::to_string(n) + " corners and is not convex",
                  "at most " + std::to_string(kMaxConcaveCorners) + " corners of such a face",
                  "split it into triangles in the program that made it");
  EarCutter(points).cut(add);
}

}  // namespace weir
