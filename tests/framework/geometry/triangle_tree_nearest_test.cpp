// The nearest point of a mesh and the side of it, against asking every triangle in double and against shapes
// whose inside is known.
#include <gtest/gtest.h>

#include <random>

#include "framework/compute/dispatch.h"
#include "tests/framework/geometry/triangle_tree_kernel.h"
#include "tests/support/devices.h"
#include "tests/support/meshes.h"

namespace weir::test {
namespace {

using TriangleTreeNearest = OnDevice;

std::vector<Vec3f> randomPoints(int count, float reach, const Vec3f& around = {}) {
  std::mt19937 random(11);
  std::uniform_real_distribution<float> coordinate(-reach, reach);
  std::vector<Vec3f> points;
  for (int i = 0; i < count; ++i)
    points.push_back(around + Vec3f{coordinate(random), coordinate(random), coordinate(random)});
  return points;
}

std::vector<SurfacePoint> nearestOf(Device& device, const TriangleMesh& mesh, const std::vector<Vec3f>& asked,
                                    float atMost = std::numeric_limits<float>::infinity()) {
  const TriangleTree tree(device, mesh);
  const Array<Vec3f> points(device, asked);
  Array<SurfacePoint> out(device, points.size());
  dispatch(device, [&](auto& d) { findNearest(d, tree.view(), atMost, points.view(), out.view()); });
  return out.toHost();
}

TriangleMesh soup(int triangles) {
  TriangleMesh mesh;
  mesh.vertices = randomPoints(3 * triangles, 1);
  for (int i = 0; i < triangles; ++i) {
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    // Every fifth is a sliver.
    if (i % 5 == 0) mesh.vertices[3 * i + 2] = mesh.vertices[3 * i + 1] + 1e-4f * mesh.vertices[3 * i + 2];
  }
  return mesh;
}

TEST_P(TriangleTreeNearest, IsTheNearestOfAllTriangles) {
  for (const TriangleMesh& mesh :
       {icosphere(3), boxMesh({-1, -0.5f, -0.2f}, {0.3f, 1, 0.7f}), soup(500), sheet(7)})
    for (const float reach : {1.2f, 20.0f}) {
      const std::vector<Vec3f> asked = randomPoints(500, reach);
      const std::vector<SurfacePoint> found = nearestOf(*device, mesh, asked);
      for (std::size_t i = 0; i < asked.size(); ++i) {
        const double expected = slowDistance(mesh, asked[i]);
        ASSERT_NEAR(found[i].distance, expected, 1e-6 * (1 + expected)) << i;
        ASSERT_NEAR(length(found[i].position - asked[i]), expected, 2e-6 * (1 + expected)) << i;
        TriangleMesh one = mesh;
        one.triangles = {mesh.triangles[found[i].triangle]};
        ASSERT_NEAR(slowDistance(one, found[i].position), 0, 2e-6 * (1 + expected)) << i;
      }
    }
}

TEST_P(TriangleTreeNearest, ABoundCutsDistancesOffAndChangesNoOthers) {
  const TriangleMesh mesh = soup(200);
  const std::vector<Vec3f> asked = randomPoints(500, 2);
  const std::vector<SurfacePoint> all = nearestOf(*device, mesh, asked);
  const std::vector<SurfacePoint> cut = nearestOf(*device, mesh, asked, 0.3f);
  int near = 0;
  for (std::size_t i = 0; i < asked.size(); ++i) {
    const bool isNear = all[i].distance < 0.3f;
    near += isNear;
    EXPECT_EQ(cut[i].triangle, isNear ? all[i].triangle : -1);
    EXPECT_EQ(cut[i].distance, std::min(all[i].distance, 0.3f));
  }
  EXPECT_GT(near, 50);
  EXPECT_LT(near, 450);
}

/// Points at ± distance along ± all pseudo-normals' neighbourhoods: near corners, edges and faces of a mesh.
std::vector<Vec3f> pointsNearFeatures(const TriangleMesh& mesh, float distance) {
  std::vector<Vec3f> points;
  const std::vector<Vec3f> offsets = randomPoints(12, distance);
  for (const Vec3i& t : mesh.triangles) {
    const Vec3f a = mesh.vertices[t.x], b = mesh.vertices[t.y], c = mesh.vertices[t.z];
    for (const Vec3f& at : {a, 0.5f * (a + b), (a + b + c) / 3.0f})
      for (const Vec3f& offset : offsets) points.push_back(at + offset);
  }
  return points;
}

/// In double: how far p is beyond the outermost face of a convex mesh, negative inside.
double beyondConvex(const TriangleMesh& mesh, const Vec3f& p) {
  double max = -std::numeric_limits<double>::infinity();
  const auto wide = [](const Vec3f& v) { return Vec3d{v.x, v.y, v.z}; };
  for (const Vec3i& t : mesh.triangles) {
    const Vec3d a = wide(mesh.vertices[t.x]);
    const Vec3d n = normalized(cross(wide(mesh.vertices[t.y]) - a, wide(mesh.vertices[t.z]) - a));
    max = std::max(max, dot(wide(p) - a, n));
  }
  return max;
}

TEST_P(TriangleTreeNearest, SideOfConvexSolidsIsRightAtFacesEdgesAndCorners) {
  TriangleMesh turned = boxMesh({-1, -0.5f, -0.2f}, {0.3f, 1, 0.7f});
  turned.transform(1, quaternionFromEulerDegrees({20, 50, -70}), {});
  TriangleMesh thin = icosphere(2);
  for (Vec3f& v : thin.vertices) v.z *= 0.02f;
  for (const TriangleMesh& mesh : {icosphere(2), boxMesh({-1, -0.5f, -0.2f}, {0.3f, 1, 0.7f}), turned, thin})
    for (const float distance : {1e-4f, 1e-2f, 1.0f}) {
      const std::vector<Vec3f> asked = pointsNearFeatures(mesh, distance);
      const std::vector<SurfacePoint> found = nearestOf(*device, mesh, asked);
      for (std::size_t i = 0; i < asked.size(); ++i) {
        const double beyond = beyondConvex(mesh, asked[i]);
        if (std::abs(beyond) < 4e-6) continue;  // of unit size, in floats
        ASSERT_EQ(found[i].side, beyond > 0 ? 1 : -1) << i << " at " << distance << ", " << beyond;
      }
    }
}

TEST_P(TriangleTreeNearest, SideOfVerticesThatAreStoredTwiceIsRight) {
  // As files store them that keep normals for each triangle.
  const TriangleMesh box = boxMesh({-1, -1, -1}, {1, 1, 1});
  TriangleMesh apart;
  for (const Vec3i& t : box.triangles)
    for (int k = 0; k < 3; ++k) apart.vertices.push_back(box.vertices[t[k]]);
  for (int i = 0; i < 12; ++i) apart.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  const std::vector<Vec3f> asked = pointsNearFeatures(box, 0.1f);
  const std::vector<SurfacePoint> found = nearestOf(*device, apart, asked);
  for (std::size_t i = 0; i < asked.size(); ++i)
    if (const double beyond = beyondConvex(box, asked[i]); std::abs(beyond) > 4e-6) {
      ASSERT_EQ(found[i].side, beyond > 0 ? 1 : -1) << i;
    }
}

TEST_P(TriangleTreeNearest, SideOfASheetIsThatOfItsPlane) {
  for (const int cells : {1, 9}) {
    const std::vector<Vec3f> asked = randomPoints(1000, 3);
    const std::vector<SurfacePoint> found = nearestOf(*device, sheet(cells), asked);
    for (std::size_t i = 0; i < asked.size(); ++i) ASSERT_EQ(found[i].side, asked[i].z > 0 ? 1 : -1);
    EXPECT_EQ(nearestOf(*device, sheet(cells), {{5, 0, 0}, {0.1f, 0.2f, 0}})[0].side, 0);
  }
}

TEST_P(TriangleTreeNearest, WorksFarFromTheOrigin) {
  TriangleMesh mesh = icosphere(3, 0.1f);  // triangles of 1.5 cm
  const Vec3f far{100, -70, 40};
  for (Vec3f& v : mesh.vertices) v += far;
  const std::vector<Vec3f> asked = randomPoints(2000, 0.2f, far);
  const std::vector<SurfacePoint> found = nearestOf(*device, mesh, asked);
  for (std::size_t i = 0; i < asked.size(); ++i) {
    ASSERT_NEAR(found[i].distance, slowDistance(mesh, asked[i]), 2e-5);
    const double beyond = beyondConvex(mesh, asked[i]);
    if (std::abs(beyond) > 1e-4) {
      ASSERT_EQ(found[i].side, beyond > 0 ? 1 : -1) << beyond;
    }
  }
}

TEST_P(TriangleTreeNearest, TrianglesWithoutAreaCountAsSegmentsAndPoints) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 5, 0}};
  mesh.triangles = {{0, 2, 1}, {3, 3, 3}};
  const std::vector<SurfacePoint> found = nearestOf(*device, mesh, {{1.5f, 0, 2}, {3, 0, 0}, {0, 8, 4}});
  EXPECT_FLOAT_EQ(found[0].distance, 2);
  EXPECT_FLOAT_EQ(found[1].distance, 1);
  EXPECT_FLOAT_EQ(found[2].distance, 5);
  EXPECT_EQ(found[2].side, 0);
}

WEIR_ON_EVERY_DEVICE(TriangleTreeNearest);

}  // namespace
}  // namespace weir::test
