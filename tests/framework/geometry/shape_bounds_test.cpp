#include "framework/geometry/shape_bounds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace weir::test {
namespace {

constexpr ShapeKind kBounded[] = {ShapeKind::kBox, ShapeKind::kSphere, ShapeKind::kCylinder,
                                  ShapeKind::kCapsule, ShapeKind::kCone};

Shape someShape(ShapeKind kind, bool turned, bool inverted) {
  Shape shape{.kind = kind,
              .position = {0.3f, -0.2f, 0.1f},
              .halfSize = {0.2f, 0.1f, 0.4f},
              .radius = 0.15f,
              .height = 0.5f,
              .inverted = inverted};
  if (turned) shape.rotation = {0.9f, 0.1f, 0.3f, 0.3f};
  return shape;
}

/// How far p is outside of the box, m; negative inside.
float outside(const Aabb& box, const Vec3f& p) {
  return std::max(
      {box.lo.x - p.x, p.x - box.hi.x, box.lo.y - p.y, p.y - box.hi.y, box.lo.z - p.z, p.z - box.hi.z});
}

void expectBound(const Shape& shape) {
  constexpr int kPoints = 20000;
  constexpr float kRounding = 1e-6f;
  const std::optional<Aabb> bounds = boundsOf(shape);
  ASSERT_TRUE(bounds);
  ASSERT_FALSE(bounds->empty());
  std::mt19937 random(3);
  std::uniform_real_distribution<float> unit(-1, 1);
  int told = 0;
  for (int k = 0; k < kPoints; ++k) {
    const Vec3f p = shape.position + Vec3f{unit(random), unit(random), unit(random)};
    const float bound = shape.inverted ? -outside(*bounds, p) : outside(*bounds, p);
    if (bound <= 0) continue;
    ++told;
    ASSERT_GE(signedDistance(shape, p).distance, bound - kRounding);
  }
  EXPECT_GT(told, 0);
}

TEST(ShapeBounds, NoPointIsNearerToASolidThanItsBoundsTell) {
  for (const ShapeKind kind : kBounded)
    for (const bool turned : {false, true}) expectBound(someShape(kind, turned, false));
}

TEST(ShapeBounds, NoPointInARoomIsNearerToItsWallsThanItsBoundsTell) {
  for (const ShapeKind kind : kBounded)
    for (const bool turned : {false, true})
      if (kind != ShapeKind::kCone) expectBound(someShape(kind, turned, true));
}

TEST(ShapeBounds, PlanesAndInvertedConesHaveNone) {
  EXPECT_FALSE(boundsOf(someShape(ShapeKind::kPlane, false, false)));
  EXPECT_FALSE(boundsOf(someShape(ShapeKind::kPlane, false, true)));
  EXPECT_FALSE(boundsOf(someShape(ShapeKind::kCone, false, true)));
}

}  // namespace
}  // namespace weir::test
