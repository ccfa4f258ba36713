// Volume, centre and inertia of meshes against closed forms.
#include "framework/geometry/mass_properties.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/meshes.h"

namespace weir::test {
namespace {

TEST(MassProperties, OfABoxAnywhere) {
  const MassProperties of = massProperties(boxMesh({1, 2, -3}, {1.5f, 4, -2}));
  const double a = 0.5, b = 2, c = 1, volume = a * b * c;
  EXPECT_NEAR(of.volume, volume, 1e-12);
  EXPECT_NEAR(of.center.x, 1.25, 1e-12);
  EXPECT_NEAR(of.center.y, 3, 1e-12);
  EXPECT_NEAR(of.center.z, -2.5, 1e-12);
  EXPECT_NEAR(of.inertia.xx, volume * (b * b + c * c) / 12, 1e-12);
  EXPECT_NEAR(of.inertia.yy, volume * (c * c + a * a) / 12, 1e-12);
  EXPECT_NEAR(of.inertia.zz, volume * (a * a + b * b) / 12, 1e-12);
  EXPECT_NEAR(of.inertia.xy, 0, 1e-12);
  EXPECT_NEAR(of.inertia.yz, 0, 1e-12);
  EXPECT_NEAR(of.inertia.zx, 0, 1e-12);
}

TEST(MassProperties, OfATurnedBoxAreTurned) {
  TriangleMesh box = boxMesh({-0.5f, -1, -0.25f}, {0.5f, 1, 0.25f});
  const float c = std::sqrt(0.5f);
  box.transform(1, {c, 0, 0, c}, {3, 0, 0});  // a quarter turn about z: x and y change places
  const MassProperties of = massProperties(box);
  EXPECT_NEAR(of.center.x, 3, 1e-6);
  EXPECT_NEAR(of.inertia.xx, (1 + 0.25) / 12, 1e-6);
  EXPECT_NEAR(of.inertia.yy, (4 + 0.25) / 12, 1e-6);
  EXPECT_NEAR(of.inertia.zz, 5.0 / 12, 1e-6);
  // By an eighth, there are products of inertia: R·diag·Rᵀ.
  TriangleMesh tilted = boxMesh({-0.5f, -1, -0.25f}, {0.5f, 1, 0.25f});
  const float half = std::numbers::pi_v<float> / 8;
  tilted.transform(1, {std::cos(half), 0, 0, std::sin(half)}, {});
  const double x = (4 + 0.25) / 12, y = (1 + 0.25) / 12;
  EXPECT_NEAR(massProperties(tilted).inertia.xy, 0.5 * (x - y), 1e-6);
  EXPECT_NEAR(massProperties(tilted).inertia.xx, 0.5 * (x + y), 1e-6);
}

/// The inscribed mesh has less, by a share that falls with the square of its edges.
TEST(MassProperties, OfASphere) {
  constexpr double kRadius = 2;
  const double volume = 4 * std::numbers::pi / 3 * std::pow(kRadius, 3);
  const double inertia = 0.4 * volume * kRadius * kRadius;
  double missing = 0;
  for (const int levels : {2, 3, 4}) {
    const MassProperties of = massProperties(icosphere(levels, kRadius));
    const double lacks = 1 - of.volume / volume;
    EXPECT_GT(lacks, 0);
    if (missing > 0) {
      EXPECT_NEAR(missing / lacks, 4, 0.1);
    }
    missing = lacks;
    EXPECT_NEAR(of.inertia.xx / inertia, 1 - 5.0 / 3 * lacks, 0.1 * lacks);  // as radius⁵ falls with radius³
    EXPECT_NEAR(of.inertia.xy / inertia, 0, 1e-6);
    EXPECT_NEAR(length(of.center), 0, 1e-6);
  }
  EXPECT_LT(missing, 4e-3);
}

/// A prism over a regular polygon of n sides, in the closed form of polygons.
TEST(MassProperties, OfACylinder) {
  constexpr int kSides = 48;
  constexpr double kRadius = 0.3, kHeight = 1.2;
  TriangleMesh mesh;
  for (int k = 0; k < kSides; ++k) {
    const double angle = 2 * std::numbers::pi * k / kSides;
    for (const float y : {0.0f, float(kHeight)})
      mesh.vertices.push_back({float(kRadius * std::cos(angle)), y, float(kRadius * std::sin(angle))});
  }
  mesh.vertices.push_back({0, 0, 0});
  mesh.vertices.push_back({0, float(kHeight), 0});
  for (int k = 0; k < kSides; ++k) {
    const int a = 2 * k, b = 2 * ((k + 1) % kSides);
    mesh.triangles.insert(
        mesh.triangles.end(),
        {{a, a + 1, b}, {b, a + 1, b + 1}, {2 * kSides, a, b}, {2 * kSides + 1, b + 1, a + 1}});
  }
  ASSERT_TRUE(diagnose(mesh).good()) << diagnose(mesh).message();
  const MassProperties of = massProperties(mesh);
  const double wedge = 2 * std::numbers::pi / kSides, cosine = std::cos(wedge);
  const double volume = 0.5 * kSides * kRadius * kRadius * std::sin(wedge) * kHeight;
  const double square = kRadius * kRadius * (2 + cosine) / 12;  // mean of x² over the polygon
  EXPECT_NEAR(of.volume / volume, 1, 1e-6);
  EXPECT_NEAR(of.center.y, 0.5 * kHeight, 1e-6);
  EXPECT_NEAR(of.inertia.yy / (2 * volume * square), 1, 1e-6);
  EXPECT_NEAR(of.inertia.xx / (volume * (square + kHeight * kHeight / 12)), 1, 1e-6);
}

TEST(MassProperties, OfWhatIsInsideOutAndOfNothing) {
  TriangleMesh box = boxMesh({0, 0, 0}, {1, 1, 1});
  box.flip();
  EXPECT_NEAR(massProperties(box).volume, -1, 1e-12);
  EXPECT_EQ(massProperties({}).volume, 0);
}

}  // namespace
}  // namespace weir::test
