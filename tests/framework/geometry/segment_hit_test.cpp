// The first hit of a segment against asking every triangle in double, and where rays go exactly through edges
// and vertices.
#include "framework/geometry/segment_hit.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <random>

#include "tests/support/meshes.h"

namespace weir::test {
namespace {

Vec3d wide(const Vec3f& v) {
  return {v.x, v.y, v.z};
}

class Random {
 public:
  Vec3f point(float reach) {
    std::uniform_real_distribution<float> coordinate(-reach, reach);
    return {coordinate(random_), coordinate(random_), coordinate(random_)};
  }

 private:
  std::mt19937 random_{13};
};

/// The fraction at which the segment meets the mesh by solving for barycentric coordinates (Möller and
/// Trumbore 1997), above 1 if it does not; `closest` is set to how near any border of a triangle came to
/// deciding.
double slowFraction(const TriangleMesh& mesh, const Vec3f& p, const Vec3f& q, double& closest) {
  double first = 2;
  closest = 1;
  const Vec3d motion = wide(q) - wide(p);
  for (const Vec3i& t : mesh.triangles) {
    const Vec3d a = wide(mesh.vertices[t.x]), ab = wide(mesh.vertices[t.y]) - a,
                ac = wide(mesh.vertices[t.z]) - a;
    const Vec3d h = cross(motion, ac), s = wide(p) - a, r = cross(s, ab);
    const double determinant = dot(ab, h), u = dot(s, h) / determinant, v = dot(motion, r) / determinant,
                 fraction = dot(ac, r) / determinant;
    const double within = std::min({u, v, 1 - u - v, fraction, 1 - fraction});
    closest = std::min(closest, std::abs(within));
    if (within >= 0) first = std::min(first, fraction);
  }
  return first;
}

TEST(SegmentHit, IsTheFirstOfAllTriangles) {
  Random random;
  CpuDevice device(1);
  TriangleMesh soup;
  for (int i = 0; i < 400; ++i) {
    const Vec3f at = random.point(1);
    const float size = std::pow(0.1f, static_cast<float>(i % 3));
    soup.vertices.insert(soup.vertices.end(), {at, at + random.point(size), at + random.point(size)});
    soup.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  for (const TriangleMesh& mesh : {soup, icosphere(2), boxMesh({-1, -0.5f, -0.2f}, {0.3f, 1, 0.7f})}) {
    const TriangleTree tree(device, mesh);
    int hits = 0, judged = 0;
    for (int i = 0; i < 2000; ++i) {
      const float scale = std::pow(0.5f, static_cast<float>(i % 6));
      const Vec3f p = random.point(1.5f), q = p + random.point(2 * scale);
      double closest = 0;
      const double expected = slowFraction(mesh, p, q, closest);
      if (closest < 1e-9) continue;  // rounding decides there
      const SegmentHit hit = firstHit(tree.view(), p, q);
      ++judged, hits += hit.found();
      ASSERT_EQ(hit.found(), expected <= 1) << i;
      if (!hit.found()) continue;
      ASSERT_NEAR(hit.fraction, expected, 1e-9);
      const Vec3f motion = q - p;
      ASSERT_LE(dot(hit.normal, motion), 1e-6f);
      ASSERT_NEAR(hit.height, -hit.fraction * dot(wide(hit.normal), wide(motion)), 2e-6);
    }
    EXPECT_GT(judged, 1900);
    EXPECT_GT(hits, 100);
  }
}

TEST(SegmentHit, SignsOfVolumesAreRightOrNotGiven) {
  // Three long integer vectors that differ by little: the volume is exact in 128 bits, and lost in a
  // double's 53.
  std::mt19937_64 random(5);
  const auto integer = [&](int bits) {
    return static_cast<std::int64_t>(random() >> (64 - bits)) - (std::int64_t{1} << (bits - 1));
  };
  const auto asDouble = [](const Vec3<std::int64_t>& a) {
    return Vec3d{static_cast<double>(a.x), static_cast<double>(a.y), static_cast<double>(a.z)};
  };
  using Wide = __int128;
  int given = 0, wrongInDouble = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vec3<std::int64_t> u{integer(30), integer(30), integer(30)};
    const int bits = 2 + i % 12;
    const Vec3<std::int64_t> v = u + Vec3<std::int64_t>{integer(bits), integer(bits), integer(bits)};
    const Vec3<std::int64_t> w = u + Vec3<std::int64_t>{integer(bits), integer(bits), integer(bits)};
    const Wide exact = u.x * (Wide{v.y} * w.z - Wide{v.z} * w.y) + u.y * (Wide{v.z} * w.x - Wide{v.x} * w.z) +
                       u.z * (Wide{v.x} * w.y - Wide{v.y} * w.x);
    const int sign = exact > 0 ? 1 : (exact < 0 ? -1 : 0);
    const detail::Volume found = detail::volume(asDouble(u), asDouble(v), asDouble(w));
    wrongInDouble += (found.value > 0 ? 1 : (found.value < 0 ? -1 : 0)) != sign;
    if (found.sign == 0) continue;
    ++given;
    ASSERT_EQ(found.sign, sign) << i;
  }
  EXPECT_GT(given, 1000);
  EXPECT_GT(wrongInDouble, 500);  // so the test can fail
}

TEST(SegmentHit, NoSegmentSlipsThroughEdgesAndVerticesThatItMeetsExactly) {
  // All coordinates are exact in floats, and so are the ties.
  CpuDevice device(1);
  const TriangleTree tree(device, sheet(8));
  const float offsets[] = {0, 0.125f, 0.0625f, 0.25f, -0.5f};
  for (const float x : offsets)
    for (const float y : offsets)
      for (const Vec3f& along :
           {Vec3f{0, 0, 1}, {0.25f, 0, 1}, {0.25f, -0.125f, 0.5f}, {0.25f, 0.25f, 0.25f}})
        for (const float sign : {1.0f, -1.0f}) {
          const Vec3f at{x, y, 0}, motion = sign * along;
          EXPECT_TRUE(firstHit(tree.view(), at - motion, at + motion).found()) << x << ", " << y;
          EXPECT_TRUE(firstHit(tree.view(), at - motion, at).found()) << x << ", " << y;
          EXPECT_FALSE(firstHit(tree.view(), at - motion, at - 0.5f * motion).found()) << x << ", " << y;
        }
}

TEST(SegmentHit, NoSegmentLeavesASolidUnseenThroughItsEdgesAndVertices) {
  Random random;
  CpuDevice device(1);
  TriangleMesh turned = boxMesh({-1, -1, -1}, {1, 1, 1});
  turned.transform(0.7f, quaternionFromEulerDegrees({20, 50, -70}), {});
  TriangleMesh far = icosphere(2, 0.5f);
  const Vec3f place{300, -200, 100};
  for (Vec3f& v : far.vertices) v += place;
  const std::array<std::pair<TriangleMesh, Vec3f>, 3> cases{
      {{icosphere(3, 0.9f), {}}, {turned, {}}, {far, place}}};
  for (const auto& [mesh, center] : cases) {
    const TriangleTree tree(device, mesh);
    for (const Vec3i& t : mesh.triangles)
      for (int k = 0; k < 3; ++k) {
        const Vec3f a = mesh.vertices[t[k]], b = mesh.vertices[t[(k + 1) % 3]];
        const Vec3f p = center + random.point(0.1f);
        for (const float share : {0.0f, 0.5f, 0.3f}) {
          const Vec3f at = a + share * (b - a);
          ASSERT_TRUE(firstHit(tree.view(), p, p + 3.0f * (at - p)).found());
          ASSERT_TRUE(firstHit(tree.view(), p + 100.0f * (at - p), p).found());
        }
      }
  }
}

TEST(SegmentHit, SegmentsInThePlaneOfAFaceMeetItsNeighboursOnly) {
  CpuDevice device(1);
  const TriangleTree box(device, boxMesh({-1, -1, -1}, {1, 1, 1}));
  EXPECT_TRUE(firstHit(box.view(), {-3, 0.25f, 1}, {3, 0.5f, 1}).found());
  EXPECT_FALSE(firstHit(box.view(), {-3, 2.5f, 1}, {3, 2.25f, 1}).found());
  EXPECT_FALSE(firstHit(box.view(), {-3, 0.25f, 1}, {-2, 0.5f, 1}).found());
  const TriangleTree flat(device, sheet(4));
  EXPECT_FALSE(firstHit(flat.view(), {-3, 0.3f, 0}, {3, 0.2f, 0}).found());
}

TEST(SegmentHit, OnlyBoxesNearTheSegmentCountAsNear) {
  CpuDevice device(1);
  const TriangleTree tree(device, icosphere(4));
  EXPECT_FALSE(mayComeNear(tree.view(), {0, 0, 0}, {0.5f, 0.5f, 0.5f}, 0.01f));
  EXPECT_TRUE(mayComeNear(tree.view(), {0, 0, 0}, {0.5f, 0.5f, 0.5f}, 0.2f));
  EXPECT_FALSE(mayComeNear(tree.view(), {-2, 0, 1.1f}, {2, 0, 1.1f}, 0.01f));
  EXPECT_TRUE(mayComeNear(tree.view(), {-2, 0, 1.1f}, {2, 0, 1.1f}, 0.11f));
  EXPECT_FALSE(mayComeNear(tree.view(), {-2.2f, -1, -0.5f}, {0.8f, 2, 2.5f}, 0.01f));
  EXPECT_FALSE(mayComeNear(tree.view(), {1e9f, 0, 2}, {-1e9f, 0, 2}, 0.5f));
  EXPECT_TRUE(mayComeNear(tree.view(), {1e9f, 0, 0}, {-1e9f, 0, 0}, 0));
  EXPECT_FALSE(mayComeNear(TriangleTreeView{}, {0, 0, 0}, {1, 1, 1}, 100));
}

}  // namespace
}  // namespace weir::test
