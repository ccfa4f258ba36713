// Simplified meshes against what they came from: distances by another tree, topology by the diagnosis, and
// the integrals that fluids feel.
#include "framework/geometry/simplified_mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "framework/geometry/mesh_query.h"
#include "framework/geometry/surface_of_revolution.h"
#include "framework/solids/solid_integrals.h"
#include "tests/support/meshes.h"

namespace weir::test {
namespace {

/// A bowl with a rim and a foot on the axis, of slivers: 1 m wide, 2·2048·7 triangles.
TriangleMesh bowl() {
  const std::vector<Vec2f> profile{{0, 0},         {0.2f, 0},     {0.25f, 0.1f}, {0.4f, 0.3f}, {0.5f, 0.5f},
                                   {0.47f, 0.52f}, {0.36f, 0.3f}, {0.2f, 0.12f}, {0, 0.1f}};
  return surfaceOfRevolution(revolutionOutline(profile, {}), 2048);
}

/// Points all over a mesh, corners and edges among them.
std::vector<Vec3f> pointsOn(const TriangleMesh& mesh, int perTriangle) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> unit(0, 1);
  std::vector<Vec3f> points = mesh.vertices;
  for (const Vec3i& t : mesh.triangles) {
    const Vec3f a = mesh.vertices[t.x], ab = mesh.vertices[t.y] - a, ac = mesh.vertices[t.z] - a;
    for (int k = 0; k < perTriangle; ++k) {
      const float u = unit(random), v = unit(random) * (1 - u);
      points.push_back(a + u * ab + (k % 2 == 0 ? 0.0f : v) * ac);
    }
  }
  return points;
}

double farthest(const std::vector<Vec3f>& points, const TriangleMesh& from) {
  const MeshQuery query(from);
  double max = 0;
  for (const Vec3f& p : points) max = std::max(max, double(query.closestDistance(p)));
  return max;
}

void expectWithin(const TriangleMesh& mesh, const SimplifiedMesh& coarse, double tolerance) {
  constexpr double kRounding = 1e-6;
  EXPECT_LE(coarse.deviation, tolerance);
  EXPECT_LE(farthest(pointsOn(mesh, 2), coarse.mesh), coarse.deviation + kRounding);
  const int perTriangle = static_cast<int>(2 * mesh.triangles.size() / coarse.mesh.triangles.size());
  EXPECT_LE(farthest(pointsOn(coarse.mesh, perTriangle), mesh), coarse.deviation + kRounding);
}

TEST(SimplifiedMesh, CurvedSurfacesLoseSliversWithinTheTolerance) {
  const TriangleMesh mesh = bowl();
  for (const double tolerance : {1e-4, 1e-3}) {
    const SimplifiedMesh coarse = simplified(mesh, tolerance);
    EXPECT_LT(coarse.mesh.triangles.size() * 4, mesh.triangles.size());
    EXPECT_TRUE(diagnose(coarse.mesh).good()) << diagnose(coarse.mesh).message();
    // The bound holds, and is not idle.
    expectWithin(mesh, coarse, tolerance);
    EXPECT_GT(farthest(mesh.vertices, coarse.mesh), 0.1 * tolerance);
    EXPECT_NEAR(coarse.mesh.volume(), mesh.volume(), mesh.area() * tolerance);
  }
  const TriangleMesh sphere = icosphere(5);
  const SimplifiedMesh coarse = simplified(sphere, 0.01);
  EXPECT_LT(coarse.mesh.triangles.size() * 5, sphere.triangles.size());
  EXPECT_TRUE(diagnose(coarse.mesh).good()) << diagnose(coarse.mesh).message();
  expectWithin(sphere, coarse, 0.01);
}

TEST(SimplifiedMesh, FlatFacesLoseAllInnerVerticesExactly) {
  const TriangleMesh mesh = sheet(40);
  const SimplifiedMesh coarse = simplified(mesh, 1e-6);
  EXPECT_LT(coarse.deviation, 1e-12);
  EXPECT_NEAR(coarse.mesh.area(), 4, 1e-5);
  // The border stays as it is: all that is left is about a triangle for each of its edges.
  EXPECT_EQ(diagnose(coarse.mesh).openEdges, diagnose(mesh).openEdges);
  EXPECT_LT(coarse.mesh.triangles.size(), 400u);
  for (const Vec3i& t : coarse.mesh.triangles) {
    const Vec3f a = coarse.mesh.vertices[t.x];
    EXPECT_GT(cross(coarse.mesh.vertices[t.y] - a, coarse.mesh.vertices[t.z] - a).z, 0);
  }
}

TEST(SimplifiedMesh, WhatIsNoSimpleFanStays) {
  const auto same = [](const TriangleMesh& mesh, double tolerance) {
    const SimplifiedMesh coarse = simplified(mesh, tolerance);
    EXPECT_EQ(coarse.mesh.vertices, mesh.vertices);
    EXPECT_EQ(coarse.mesh.triangles, mesh.triangles);
    EXPECT_EQ(coarse.deviation, 0);
  };
  same(bowl(), 0);
  same({}, 1);
  same(boxMesh({0, 0, 0}, {1, 1, 1}), 0.01);
  // Even where any deviation is allowed, a tetrahedron is not flattened.
  same({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}}, 10);
  // Three sheets at one edge, and two that are turned differently.
  same({{{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {-1, 0, 0}, {0, 0, 1}}, {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}}}, 10);
  same({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, -1, 0}}, {{0, 1, 2}, {0, 3, 2}, {0, 3, 1}}}, 10);
}

TEST(SimplifiedMesh, FeaturesStayAndDuplicatesDoNoHarm) {
  // An edge of 90° that is finely divided: its vertices merge along it, never off it.
  TriangleMesh block = boxMesh({0, 0, 0}, {1, 1, 1});
  for (int level = 0; level < 4; ++level) {
    TriangleMesh finer;
    for (const Vec3i& t : block.triangles) {
      const Vec3f a = block.vertices[t.x], b = block.vertices[t.y], c = block.vertices[t.z];
      const Vec3f ab = 0.5f * (a + b), bc = 0.5f * (b + c), ca = 0.5f * (c + a);
      for (const auto& corners : {std::array{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}}) {
        const int first = static_cast<int>(finer.vertices.size());
        finer.vertices.insert(finer.vertices.end(), corners.begin(), corners.end());
        finer.triangles.push_back({first, first + 1, first + 2});
      }
    }
    block = cleaned(finer);
  }
  const SimplifiedMesh coarse = simplified(block, 0.01);
  EXPECT_LT(coarse.mesh.triangles.size(), 100u);
  EXPECT_TRUE(diagnose(coarse.mesh).good());
  EXPECT_LT(farthest(pointsOn(block, 1), coarse.mesh), 1e-6);

  TriangleMesh twice = block;
  twice.triangles.insert(twice.triangles.end(), block.triangles.begin(), block.triangles.end());
  expectWithin(twice, simplified(twice, 0.01), 0.01);
}

TEST(SimplifiedMesh, FluidFeelsNoMoreThanTheDeviation) {
  const TriangleMesh mesh = bowl();
  constexpr double kRadius = 0.05, kTolerance = 0.01 * kRadius;
  const SimplifiedMesh coarse = simplified(mesh, kTolerance);
  const MeshQuery query(mesh);
  const auto phi = [&](const TriangleMesh& of, const Vec3f& p) {
    SolidIntegrator<double> sum({p.x, p.y, p.z}, kRadius);
    const auto corner = [&](int v) { return Vec3d{of.vertices[v].x, of.vertices[v].y, of.vertices[v].z}; };
    for (const Vec3i& t : of.triangles) sum.addTriangle(corner(t.x), corner(t.y), corner(t.z));
    return sum.integrals(1).phi;
  };
  std::mt19937 random(5);
  std::uniform_real_distribution<float> unit(-1, 1);
  int compared = 0;
  for (const Vec3f& on : pointsOn(coarse.mesh, 1)) {
    const Vec3f p = on + float(0.7 * kRadius) * Vec3f{unit(random), unit(random), unit(random)};
    const float distance = query.closestDistance(p);
    if (random() % 16 != 0 || distance < 0.1 * kRadius || distance > 0.9 * kRadius) continue;
    // ∫ W over a plane through the particle is 3/(2·H): more than any layer of this thickness adds.
    EXPECT_NEAR(phi(coarse.mesh, p), phi(mesh, p), 1.5 * 1.5 / kRadius * coarse.deviation);
    ++compared;
  }
  EXPECT_GT(compared, 50);
}

}  // namespace
}  // namespace weir::test
