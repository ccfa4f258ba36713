#include "plugins/rendering/gl/mesh_store.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "framework/base/check.h"

namespace weir::rendering::gl {
namespace {

/// The cube of ±1; every vertex is shared by three sides.
TriangleMesh cube() {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.vertices.push_back({i & 1 ? 1.f : -1.f, i & 2 ? 1.f : -1.f, i & 4 ? 1.f : -1.f});
  mesh.triangles = {{0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}};
  return mesh;
}

TriangleMesh sphere(int rows, int columns) {
  TriangleMesh mesh;
  for (int row = 0; row <= rows; ++row)
    for (int column = 0; column < columns; ++column) {
      const float polar = std::numbers::pi_v<float> * float(row) / float(rows);
      const float turn = 2 * std::numbers::pi_v<float> * float(column) / float(columns);
      const float across = row == 0 || row == rows ? 0 : std::sin(polar);  // poles are one point exactly
      mesh.vertices.push_back({across * std::cos(turn), std::cos(polar), -across * std::sin(turn)});
    }
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      const int a = row * columns + column, b = row * columns + (column + 1) % columns;
      mesh.triangles.push_back({a, a + columns, b});
      mesh.triangles.push_back({b, a + columns, b + columns});
    }
  return mesh;
}

TEST(MeshNormals, EdgesOfACubeAreSharp) {
  const auto vertices = withNormals(cube());
  ASSERT_EQ(vertices.size(), 36u);
  for (const MeshVertex& v : vertices) {
    // On the side that the normal belongs to, the normal's axis is at ±1, and the other axes have no part of
    // it.
    EXPECT_NEAR(dot(v.normal, v.position), 1, 1e-5f);
    EXPECT_NEAR(std::abs(v.normal.x) + std::abs(v.normal.y) + std::abs(v.normal.z), 1, 1e-5f);
  }
}

TEST(MeshNormals, OfASphereAreItsRadii) {
  for (const MeshVertex& v : withNormals(sphere(24, 48)))
    EXPECT_GT(dot(v.normal, v.position), 0.997f) << v.position.x << " " << v.position.y;
}

TEST(MeshNormals, BadTrianglesAreLeftOut) {
  TriangleMesh mesh = cube();
  mesh.vertices.push_back({std::numeric_limits<float>::quiet_NaN(), 0, 0});
  mesh.triangles.push_back({0, 1, 8});
  mesh.triangles.push_back({0, 1, 1});
  EXPECT_EQ(withNormals(mesh).size(), 36u);
  mesh.triangles.push_back({0, 1, 9});
  EXPECT_THROW(withNormals(mesh), InternalError);
}

}  // namespace
}  // namespace weir::rendering::gl
