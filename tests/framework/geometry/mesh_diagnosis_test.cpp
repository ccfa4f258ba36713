// Meshes with known faults.
#include <gtest/gtest.h>

#include "tests/support/meshes.h"

namespace weir::test {
namespace {

TEST(MeshDiagnosis, GoodMeshesHaveNothing) {
  for (const TriangleMesh& mesh : {icosphere(3), boxMesh({-1, -1, -1}, {1, 1, 1})}) {
    EXPECT_TRUE(diagnose(mesh).good());
    EXPECT_EQ(diagnose(mesh).message(), "");
  }
}

TEST(MeshDiagnosis, CountsFlippedTrianglesAndTheirEdges) {
  TriangleMesh mesh = icosphere(3);
  // The first and the last touch no common vertex.
  for (Vec3i* t : {&mesh.triangles.front(), &mesh.triangles.back()}) std::swap(t->y, t->z);
  const MeshDiagnosis found = diagnose(mesh);
  EXPECT_EQ(found.flippedTriangles, 2);
  EXPECT_EQ(found.inconsistentEdges, 6);
  EXPECT_EQ(found.openEdges, 0);
  EXPECT_FALSE(found.good());
  EXPECT_EQ(found.message(),
            "6 edges between triangles that are turned differently, 2 triangles turned against most of their "
            "neighbours");
}

TEST(MeshDiagnosis, FlippedTrianglesAreTheFewerOnesOfEachPart) {
  TriangleMesh mesh = icosphere(2);
  mesh.flip();
  std::swap(mesh.triangles[7].y, mesh.triangles[7].z);
  append(mesh, icosphere(1), {5, 0, 0});
  EXPECT_EQ(diagnose(mesh).flippedTriangles, 1);
  EXPECT_EQ(diagnose(mesh).inconsistentEdges, 3);
}

TEST(MeshDiagnosis, CountsCoincidentLayers) {
  for (const bool turned : {false, true}) {
    TriangleMesh mesh = sheet(3);
    for (const Vec3i& t : sheet(3).triangles) mesh.triangles.push_back(turned ? Vec3i{t.x, t.z, t.y} : t);
    const MeshDiagnosis found = diagnose(mesh);
    EXPECT_EQ(found.duplicateTriangles, 18);
    EXPECT_EQ(found.nonManifoldEdges, 21);  // (3·18 − 12)/2 within the sheet
    EXPECT_EQ(found.openEdges, 0);
    EXPECT_EQ(found.inconsistentEdges, turned ? 0 : 12);
    EXPECT_FALSE(found.good());
  }
}

TEST(MeshDiagnosis, CleaningMergesLayersWithVerticesOfTheirOwn) {
  TriangleMesh mesh = sheet(3);
  append(mesh, sheet(3));
  EXPECT_EQ(diagnose(mesh).openEdges, 24);
  const TriangleMesh clean = cleaned(mesh);
  EXPECT_EQ(clean.triangles.size(), 18u);
  EXPECT_EQ(diagnose(clean).duplicateTriangles, 0);
  EXPECT_EQ(diagnose(clean).openEdges, 12);
}

TEST(MeshDiagnosis, CountsHolesEmptyTrianglesAndWhatIsNoNumber) {
  TriangleMesh mesh = icosphere(2);
  mesh.triangles.pop_back();
  EXPECT_EQ(diagnose(mesh).openEdges, 3);
  mesh.triangles.push_back({4, 4, 9});
  EXPECT_EQ(diagnose(mesh).degenerateTriangles, 1);
  mesh.vertices.push_back({0, std::numeric_limits<float>::quiet_NaN(), 0});
  EXPECT_EQ(diagnose(mesh).nonFiniteVertices, 1);
  TriangleMesh inside = icosphere(1);
  inside.flip();
  EXPECT_TRUE(diagnose(inside).insideOut);
  EXPECT_EQ(diagnose(inside).flippedTriangles, 0);
}

TEST(MeshDiagnosis, AMoebiusStripIsInconsistentSomewhere) {
  TriangleMesh strip;
  const int n = 8;
  for (int i = 0; i < n; ++i) {
    const float angle = 0.7853982f * static_cast<float>(i), half = 0.5f * angle;
    for (const float w : {-0.3f, 0.3f}) {
      const float r = 1 + w * std::cos(half);
      strip.vertices.push_back({r * std::cos(angle), r * std::sin(angle), w * std::sin(half)});
    }
    const int a = 2 * i, b = a + 1, c = i + 1 < n ? a + 2 : 1, d = i + 1 < n ? a + 3 : 0;
    strip.triangles.insert(strip.triangles.end(), {{a, b, d}, {a, d, c}});
  }
  EXPECT_EQ(diagnose(strip).inconsistentEdges, 1);
}

}  // namespace
}  // namespace weir::test
