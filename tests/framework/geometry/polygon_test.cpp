// Polygons become triangles that fill them.
#include "framework/geometry/polygon.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>

#include "framework/base/error.h"
#include "tests/support/expect_error.h"

namespace weir::test {
namespace {

struct Filled {
  double area = 0;      ///< of all triangles, each as a positive number
  Vec3f twiceNormal{};  ///< the sum of their normals
  std::size_t triangles = 0;
};

Filled fill(const std::vector<Vec3f>& vertices) {
  std::vector<int> corners(vertices.size());
  std::iota(corners.begin(), corners.end(), 0);
  std::vector<Vec3i> triangles;
  addPolygon(corners, vertices, triangles);
  Filled filled{.triangles = triangles.size()};
  for (const Vec3i& t : triangles) {
    const auto at = [&](int k) { return vertices[static_cast<std::size_t>(t[k])]; };
    const Vec3f n = cross(at(1) - at(0), at(2) - at(0));
    filled.area += 0.5 * double(length(n));
    filled.twiceNormal = filled.twiceNormal + n;
  }
  return filled;
}

TEST(Polygon, AConvexOneIsAFan) {
  const Filled square = fill({{0, 0, 0}, {2, 0, 0}, {2, 3, 0}, {0, 3, 0}});
  EXPECT_EQ(square.triangles, 2u);
  EXPECT_NEAR(square.area, 6, 1e-6);
  EXPECT_NEAR(square.twiceNormal.z, 12, 1e-5);
  EXPECT_EQ(fill({{0, 0, 0}, {1, 0, 0}}).triangles, 0u);
}

// Were it a fan, triangles would overlap, and the sum of their areas be larger than the polygon's.
TEST(Polygon, OneThatIsNotConvexIsFilledOnce) {
  const Filled arrow = fill({{0, 2, 0}, {-1, -1, 0}, {0, 0, 0}, {1, -1, 0}});
  EXPECT_EQ(arrow.triangles, 2u);
  EXPECT_NEAR(arrow.area, 2, 1e-6);
  // A comb, standing upright in space, both ways round.
  std::vector<Vec3f> comb;
  for (int i = 0; i < 10; ++i) {
    comb.push_back({float(2 * i), float(2 * i), 0});
    comb.push_back({float(2 * i + 1), float(2 * i + 1), 5});
  }
  comb.push_back({20, 20, -1});
  comb.push_back({0, 0, -1});
  double area = 0;  // by the shoelace formula in the plane
  for (std::size_t i = 0; i < comb.size(); ++i) {
    const Vec3f a = comb[i], b = comb[(i + 1) % comb.size()];
    area += 0.5 * std::sqrt(2.0) * (double(a.x) * double(b.z) - double(b.x) * double(a.z));
  }
  const Filled forth = fill(comb);
  EXPECT_EQ(forth.triangles, comb.size() - 2);
  EXPECT_NEAR(forth.area, std::abs(area), 1e-4);
  std::reverse(comb.begin(), comb.end());
  const Filled back = fill(comb);
  EXPECT_NEAR(back.area, std::abs(area), 1e-4);
  EXPECT_NEAR(length(forth.twiceNormal + back.twiceNormal), 0, 1e-3);
}

TEST(Polygon, AHoleWithASeamStaysAHole) {
  // A square of 4 with a hole of 2, cut in from one corner of each.
  const Filled ring = fill({{0, 0, 0},
                            {4, 0, 0},
                            {4, 4, 0},
                            {0, 4, 0},
                            {0, 0, 0},
                            {1, 1, 0},
                            {1, 3, 0},
                            {3, 3, 0},
                            {3, 1, 0},
                            {1, 1, 0}});
  EXPECT_NEAR(ring.area, 16 - 4, 1e-5);
}

TEST(Polygon, AnythingComesToAnEnd) {
  std::vector<Vec3f> star;  // winds twice around
  for (int i = 0; i < 999; ++i) {
    const double angle = 2 * std::numbers::pi * 2 * i / 999;
    star.push_back({float(std::cos(angle)), float(std::sin(angle)), 0});
  }
  EXPECT_EQ(fill(star).triangles, 997u);
  EXPECT_EQ(fill(std::vector<Vec3f>(50, Vec3f{1, 1, 1})).triangles, 48u);
  const float nan = std::nanf("");
  EXPECT_EQ(fill({{0, 0, 0}, {nan, 0, 0}, {1, 1, 0}, {0, 1, nan}, {0, 2, 0}}).triangles, 3u);
  std::vector<Vec3f> saw;
  for (int i = 0; i < 5000; ++i) saw.push_back({float(i), float(i % 2), 0});
  saw.push_back({5000, 9, 0});
  EXPECT_CONTAINS(errorOf([&] { fill(saw); }).what(), "5001 corners");
}

}  // namespace
}  // namespace weir::test
