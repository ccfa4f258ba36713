// The tree against asking every triangle.
#include "framework/geometry/mesh_query.h"

#include <gtest/gtest.h>

#include <random>

#include "framework/base/check.h"
#include "tests/support/meshes.h"

namespace weir::test {
namespace {

std::vector<Vec3f> randomPoints(int count, float reach, const Vec3f& around = {}) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> coordinate(-reach, reach);
  std::vector<Vec3f> points;
  for (int i = 0; i < count; ++i)
    points.push_back(around + Vec3f{coordinate(random), coordinate(random), coordinate(random)});
  return points;
}

/// Triangles without any order: slivers, overlaps, all sizes.
TriangleMesh soup(int triangles) {
  TriangleMesh mesh;
  mesh.vertices = randomPoints(3 * triangles, 1);
  for (int i = 0; i < triangles; ++i) mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  return mesh;
}

std::string print(const Vec3f& p) {
  return std::to_string(p.x) + ", " + std::to_string(p.y) + ", " + std::to_string(p.z);
}

TEST(MeshQuery, DistanceIsThatToTheNearestOfAllTriangles) {
  for (const TriangleMesh& mesh :
       {icosphere(3), boxMesh({-1, -0.5f, -0.2f}, {0.3f, 1, 0.7f}), soup(300), soup(1)}) {
    const MeshQuery query(mesh);
    for (const float reach : {1.5f, 20.0f})
      for (const Vec3f& p : randomPoints(1000, reach)) {
        const double expected = slowDistance(mesh, p);
        ASSERT_NEAR(query.closestDistance(p), expected, 1e-6 * (1 + expected)) << print(p);
      }
  }
}

TEST(MeshQuery, DistanceIsZeroAtVertices) {
  const TriangleMesh mesh = icosphere(2);
  const MeshQuery query(mesh);
  for (const Vec3f& v : mesh.vertices) EXPECT_EQ(query.closestDistance(v), 0);
}

TEST(MeshQuery, DistanceIsExactFarFromTheOrigin) {
  TriangleMesh mesh = icosphere(2);
  const Vec3f far{1000, -2000, 500};
  for (Vec3f& v : mesh.vertices) v += far;
  const MeshQuery query(mesh);
  for (const Vec3f& p : randomPoints(300, 1.5f, far)) {
    const double expected = slowDistance(mesh, p);
    ASSERT_NEAR(query.closestDistance(p), expected, 1e-6 * expected) << print(p);
  }
}

TEST(MeshQuery, ABoundCutsDistancesOffAndChangesNoOthers) {
  const MeshQuery query(soup(200));
  for (const Vec3f& p : randomPoints(500, 2)) {
    const float distance = query.closestDistance(p);
    for (const float share : {0.1f, 0.999f, 1.001f, 3.0f})
      ASSERT_EQ(query.closestDistance(p, share * distance), std::min(share, 1.0f) * distance);
  }
}

TEST(MeshQuery, TrianglesWithoutAreaCountAsSegmentsAndPoints) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 5, 0}};
  mesh.triangles = {{0, 2, 1}, {3, 3, 3}};
  const MeshQuery query(mesh);
  EXPECT_FLOAT_EQ(query.closestDistance({1.5f, 0, 2}), 2);
  EXPECT_FLOAT_EQ(query.closestDistance({3, 0, 0}), 1);
  EXPECT_FLOAT_EQ(query.closestDistance({0, 8, 4}), 5);
  EXPECT_EQ(query.windingNumber({1, 1, 1}), 0);
}

TEST(MeshQuery, WithoutTrianglesEverythingIsFarAndOutside) {
  const MeshQuery query{TriangleMesh{}};
  EXPECT_EQ(query.closestDistance({1, 2, 3}), std::numeric_limits<float>::infinity());
  EXPECT_EQ(query.windingNumber({1, 2, 3}), 0);
}

TEST(MeshQuery, RefusesTrianglesOfVerticesThatAreNotThere) {
  TriangleMesh mesh = boxMesh({}, {1, 1, 1});
  mesh.triangles[3].y = 8;
  EXPECT_THROW(MeshQuery{mesh}, InternalError);
  mesh.triangles[3].y = -1;
  EXPECT_THROW(MeshQuery{mesh}, InternalError);
}

constexpr double kDipoleError = 0.05;

TEST(MeshQuery, WindingNumberIsOneInsideAndZeroOutsideOfClosedMeshes) {
  const MeshQuery sphere(icosphere(4));
  for (const Vec3f& p : randomPoints(3000, 2)) {
    if (std::abs(length(p) - 1) < 0.003f) continue;  // the sphere is not a polyhedron
    ASSERT_NEAR(sphere.windingNumber(p), length(p) < 1 ? 1 : 0, kDipoleError) << print(p);
  }
  const Aabb box{{-1, -0.5f, -0.2f}, {0.3f, 1, 0.7f}};
  const MeshQuery boxQuery(boxMesh(box.lo, box.hi));
  for (const Vec3f& p : randomPoints(3000, 2))
    ASSERT_NEAR(boxQuery.windingNumber(p), box.contains(p) ? 1 : 0, kDipoleError) << print(p);
}

TEST(MeshQuery, WindingNumberIsRightCloseToTheSurface) {
  const TriangleMesh mesh = icosphere(3);
  const MeshQuery query(mesh);
  for (const Vec3i& t : mesh.triangles) {
    const Vec3f center = (mesh.vertices[t.x] + mesh.vertices[t.y] + mesh.vertices[t.z]) / 3.0f;
    EXPECT_NEAR(query.windingNumber(1.00001f * center), 0, kDipoleError);
    EXPECT_NEAR(query.windingNumber(0.99999f * center), 1, kDipoleError);
  }
}

TEST(MeshQuery, WindingNumberIsTheSumOfSolidAngles) {
  TriangleMesh open = icosphere(3);
  open.triangles.resize(open.triangles.size() / 2);
  for (const TriangleMesh& mesh : {open, sheet(10)}) {
    const MeshQuery query(mesh);
    for (const Vec3f& p : randomPoints(1000, 2))
      ASSERT_NEAR(query.windingNumber(p), slowWindingNumber(mesh, p), kDipoleError) << print(p);
  }
}

TEST(MeshQuery, ExactWhereNothingIsFar) {
  // Next to a single triangle no dipole is used.
  TriangleMesh mesh;
  mesh.vertices = {{-3, -2, 0}, {3, -2, 0}, {0, 4, 0}};
  mesh.triangles = {{0, 1, 2}};
  const MeshQuery query(mesh);
  for (const Vec3f& p : randomPoints(500, 1))
    ASSERT_NEAR(query.windingNumber(p), slowWindingNumber(mesh, p), 1e-9) << print(p);
}

}  // namespace
}  // namespace weir::test
