// Signed distances to analytic solids against the nearest of many points on their surfaces.
#include "framework/geometry/shapes.h"

#include <gtest/gtest.h>

#include <numbers>
#include <random>
#include <vector>

namespace weir {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kSamples = 400;  // along each of the two directions of a surface

using Points = std::vector<Vec3d>;

Vec3d onCircle(double radius, double y, double angle) {
  return {radius * std::cos(angle), y, radius * std::sin(angle)};
}

/// Points of the surface that a curve in the half-plane (r, y) makes when it turns about the y axis.
template <class Curve>
void addRevolved(Points& points, const Curve& curve) {
  for (int i = 0; i <= kSamples; ++i) {
    const auto [r, y] = curve(double(i) / kSamples);
    for (int k = 0; k < kSamples; ++k) points.push_back(onCircle(r, y, 2 * kPi * k / kSamples));
  }
}

struct HalfPlane {
  double r, y;
};

Points surfaceOf(const Shape& s) {
  Points points;
  const double radius = s.radius, height = s.height;
  switch (s.kind) {
    case ShapeKind::kBox:
      for (int axis = 0; axis < 3; ++axis)
        for (const double side : {-1.0, 1.0})
          for (int i = 0; i <= kSamples; ++i)
            for (int k = 0; k <= kSamples; ++k) {
              Vec3d p;
              p[axis] = side * s.halfSize[axis];
              p[(axis + 1) % 3] = (2.0 * i / kSamples - 1) * s.halfSize[(axis + 1) % 3];
              p[(axis + 2) % 3] = (2.0 * k / kSamples - 1) * s.halfSize[(axis + 2) % 3];
              points.push_back(p);
            }
      break;
    case ShapeKind::kSphere:
      addRevolved(points, [&](double t) {
        return HalfPlane{radius * std::sin(kPi * t), radius * std::cos(kPi * t)};
      });
      break;
    case ShapeKind::kCylinder:
      addRevolved(points, [&](double t) { return HalfPlane{radius, (t - 0.5) * height}; });
      addRevolved(points, [&](double t) { return HalfPlane{radius * t, 0.5 * height}; });
      addRevolved(points, [&](double t) { return HalfPlane{radius * t, -0.5 * height}; });
      break;
    case ShapeKind::kCapsule:
      addRevolved(points, [&](double t) { return HalfPlane{radius, (t - 0.5) * height}; });
      for (const double end : {-1.0, 1.0})
        addRevolved(points, [&](double t) {
          return HalfPlane{radius * std::cos(kPi / 2 * t),
                           end * (0.5 * height + radius * std::sin(kPi / 2 * t))};
        });
      break;
    case ShapeKind::kCone:
      addRevolved(points, [&](double t) { return HalfPlane{radius * (1 - t), height * t}; });
      addRevolved(points, [&](double t) { return HalfPlane{radius * t, 0}; });
      break;
    case ShapeKind::kPlane:
      break;
  }
  return points;
}

bool isInside(const Shape& s, const Vec3f& p) {
  const float r = std::hypot(p.x, p.z);
  switch (s.kind) {
    case ShapeKind::kBox:
      return std::abs(p.x) < s.halfSize.x && std::abs(p.y) < s.halfSize.y && std::abs(p.z) < s.halfSize.z;
    case ShapeKind::kSphere:
      return length(p) < s.radius;
    case ShapeKind::kCylinder:
      return r < s.radius && std::abs(p.y) < s.height / 2;
    case ShapeKind::kCapsule:
      return std::hypot(r, std::max(0.0f, std::abs(p.y) - s.height / 2)) < s.radius;
    case ShapeKind::kCone:
      return p.y > 0 && r < s.radius * (1 - p.y / s.height);
    case ShapeKind::kPlane:
      return p.y < 0;
  }
  return false;
}

double nearest(const Points& points, const Vec3f& p) {
  double best = 1e300;
  for (const Vec3d& q : points) {
    const Vec3d d{q.x - p.x, q.y - p.y, q.z - p.z};
    best = std::min(best, dot(d, d));
  }
  return std::sqrt(best);
}

std::vector<Shape> solids() {
  std::vector<Shape> all(5);
  all[0].kind = ShapeKind::kBox, all[0].halfSize = {0.5f, 0.3f, 0.8f};
  all[1].kind = ShapeKind::kSphere, all[1].radius = 0.6f;
  all[2].kind = ShapeKind::kCylinder, all[2].radius = 0.4f, all[2].height = 1.2f;
  all[3].kind = ShapeKind::kCapsule, all[3].radius = 0.3f, all[3].height = 0.8f;
  all[4].kind = ShapeKind::kCone, all[4].radius = 0.5f, all[4].height = 1.0f;
  return all;
}

std::vector<Vec3f> randomPoints(int count, float reach) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> coordinate(-reach, reach);
  std::vector<Vec3f> points;
  for (int i = 0; i < count; ++i)
    points.push_back({coordinate(random), coordinate(random), coordinate(random)});
  return points;
}

TEST(Shapes, DistanceIsThatOfTheNearestSurfacePoint) {
  // Samples stand up to half a sample's diagonal from the nearest point, which matters most close by.
  constexpr double kTolerance = 3e-3;
  for (const Shape& shape : solids()) {
    const Points surface = surfaceOf(shape);
    for (const Vec3f& p : randomPoints(60, 1.2f)) {
      const double expected = nearest(surface, p) * (isInside(shape, p) ? -1 : 1);
      EXPECT_NEAR(signedDistance(shape, p).distance, expected, kTolerance)
          << "shape " << int(shape.kind) << " at " << p.x << ", " << p.y << ", " << p.z;
    }
  }
}

TEST(Shapes, StandingOutByTheDistanceEndsOnTheSurface) {
  for (const Shape& shape : solids())
    for (const Vec3f& p : randomPoints(2000, 1.2f)) {
      const SignedDistance d = signedDistance(shape, p);
      EXPECT_NEAR(length(d.normal), 1, 1e-5);
      EXPECT_NEAR(signedDistance(shape, p - d.distance * d.normal).distance, 0, 2e-6)
          << "shape " << int(shape.kind) << " at " << p.x << ", " << p.y << ", " << p.z;
    }
}

TEST(Shapes, PlaneMeasuresAlongItsNormal) {
  Shape plane;
  plane.kind = ShapeKind::kPlane;
  plane.position = {0, 2, 0};
  EXPECT_FLOAT_EQ(signedDistance(plane, {5, 3.5f, -1}).distance, 1.5f);
  EXPECT_FLOAT_EQ(signedDistance(plane, {5, 0, -1}).distance, -2);
}

TEST(Shapes, InvertedSolidsAreContainers) {
  for (Shape shape : solids())
    for (const Vec3f& p : randomPoints(200, 1)) {
      shape.inverted = false;
      const SignedDistance solid = signedDistance(shape, p);
      shape.inverted = true;
      const SignedDistance container = signedDistance(shape, p);
      EXPECT_EQ(container.distance, -solid.distance);
      EXPECT_EQ(container.normal, -solid.normal);
    }
}

TEST(Shapes, PlacedShapesMoveWithTheirFrame) {
  const Quatf turn = quaternionFromEulerDegrees({30, -50, 110});
  const Vec3f position{1, -2, 0.5f};
  for (const Shape& shape : solids()) {
    Shape placed = shape;
    placed.position = position;
    placed.rotation = turn;
    for (const Vec3f& p : randomPoints(200, 1)) {
      const SignedDistance here = signedDistance(shape, p);
      const SignedDistance there = signedDistance(placed, rotate(turn, p) + position);
      EXPECT_NEAR(there.distance, here.distance, 2e-6);
      EXPECT_NEAR(length(there.normal - rotate(turn, here.normal)), 0, 2e-3);
    }
  }
}

}  // namespace
}  // namespace weir
