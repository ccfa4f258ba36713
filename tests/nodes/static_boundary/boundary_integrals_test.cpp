// What walls by signed distance add to the density, against integrals by points, and against the gradient.
#include "nodes/static_boundary/boundary_integrals.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "framework/compute/device.h"
#include "framework/geometry/shape_bounds.h"
#include "framework/geometry/triangle_mesh.h"

namespace weir::test {
namespace {

constexpr float kRadius = 0.05f;

BoundaryPiece pieceOf(const Shape& shape) {
  BoundaryPiece piece;
  piece.shape = shape;
  const std::optional<Aabb> bounds = boundsOf(shape);
  piece.bounded = bounds.has_value();
  piece.bounds = bounds.value_or(Aabb{});
  return piece;
}

BoundaryIntegrals integralsOf(const std::vector<BoundaryPiece>& pieces) {
  return {.boundary = {pieces.data(), static_cast<int>(pieces.size()), pieces.front()},
          .radius = kRadius,
          .factor = 1};
}

/// Φ and D from many points in the ball about p that are evenly spread in radius and direction.
struct Sampled {
  double phi = 0, d = 0;
};
Sampled sample(const std::vector<BoundaryPiece>& pieces, const Vec3f& p) {
  constexpr int kPoints = 200000;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  Sampled sum;
  for (int k = 0; k < kPoints; ++k) {
    const double r = unit(random), up = 2 * unit(random) - 1, turn = 2 * std::numbers::pi * unit(random);
    const double flat = std::sqrt(1 - up * up);
    const Vec3f at = p + static_cast<float>(r * kRadius) *
                             Vec3f{float(flat * std::cos(turn)), float(up), float(flat * std::sin(turn))};
    bool solid = false;
    for (const BoundaryPiece& piece : pieces) solid = solid || piece.query(at).distance < 0;
    if (!solid) continue;
    // 4π·r²·W and 4π·r·|W'|, of the spiky kernel.
    sum.phi += 60 * r * r * std::pow(1 - r, 3) / kPoints;
    sum.d += 180 * r * std::pow(1 - r, 2) / kPoints / (double(kRadius) * kRadius);
  }
  return sum;
}

const Shape kBox{.kind = ShapeKind::kBox,
                 .position = {0.1f, 0.2f, 0.3f},
                 .rotation = {0.9f, 0.1f, 0.3f, 0.3f},
                 .halfSize = {0.1f, 0.06f, 0.08f}};

/// So thin that the kernel sees both of its faces.
const Shape kPlate{.kind = ShapeKind::kBox,
                   .position = kBox.position,
                   .rotation = kBox.rotation,
                   .halfSize = {0.1f, 0.01f, 0.08f}};

Shape inverted(Shape shape) {
  shape.inverted = true;
  return shape;
}

/// Points near the surface, at most `reach` kernel radii away.
std::vector<Vec3f> pointsNear(const std::vector<BoundaryPiece>& pieces, float reach, int count) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> at(-0.3f, 0.3f);
  std::vector<Vec3f> points;
  while (static_cast<int>(points.size()) < count) {
    const Vec3f p = Vec3f{0.1f, 0.2f, 0.3f} + Vec3f{at(random), at(random), at(random)};
    float nearest = 1;
    for (const BoundaryPiece& piece : pieces) nearest = std::min(nearest, std::fabs(piece.query(p).distance));
    if (nearest < reach * kRadius) points.push_back(p);
  }
  return points;
}

struct Case {
  const char* name;
  std::vector<BoundaryPiece> pieces;
  double tolerance;  // of Φ
};

std::vector<Case> cases() {
  const Shape plane{.kind = ShapeKind::kPlane, .position = {0.1f, 0.2f, 0.3f}, .rotation = kBox.rotation};
  Shape wall = plane;
  wall.rotation = {};
  const Shape cylinder{
      .kind = ShapeKind::kCylinder, .position = kBox.position, .radius = 0.2f, .height = 0.2f};
  const Shape sphere{.kind = ShapeKind::kSphere, .position = kBox.position, .radius = 0.2f};
  return {{"plane", {pieceOf(plane)}, 0.005},
          {"box", {pieceOf(kBox)}, 0.02},
          {"container", {pieceOf(inverted(kBox))}, 0.02},
          {"plate", {pieceOf(kPlate)}, 0.02},
          {"gap", {pieceOf(inverted(kPlate))}, 0.02},
          {"cylinder", {pieceOf(cylinder)}, 0.04},
          {"round tank", {pieceOf(inverted(cylinder))}, 0.04},
          {"ball", {pieceOf(sphere)}, 0.04},
          {"two planes that cross", {pieceOf(plane), pieceOf(wall)}, 0.1}};
}

TEST(FaceIntegrals, AreTheSameInDoublePrecision) {
  for (float q = -1.25f; q < 1.25f; q += 0.0625f) {
    const FaceIntegrals<float> single = faceIntegrals(q);
    const FaceIntegrals<double> both = faceIntegrals(double(q));
    EXPECT_NEAR(single.phi, both.phi, 1e-6) << q;
    EXPECT_NEAR(single.slope, both.slope, 1e-5) << q;
    EXPECT_NEAR(single.d, both.d, 1e-5) << q;
  }
}

TEST(BoundaryIntegrals, AreThoseOfTheMatterBehindTheSurface) {
  for (const Case& of : cases()) {
    double worst = 0;
    for (const Vec3f& p : pointsNear(of.pieces, 1, 60)) {
      const SolidIntegrals<float> found = integralsOf(of.pieces).at(p);
      const Sampled expected = sample(of.pieces, p);
      worst = std::max(worst, std::fabs(found.phi - expected.phi));
      EXPECT_GT(found.d, 0.9 * expected.d - 0.2 / (kRadius * kRadius)) << of.name;
    }
    std::printf("%s: Φ is right to %.4f\n", of.name, worst);
    EXPECT_LT(worst, of.tolerance) << of.name;
  }
}

/// ∇Φ by central differences.
Vec3f differences(const BoundaryIntegrals& integrals, const Vec3f& p) {
  constexpr float kStep = 1e-3f * kRadius;
  Vec3f result;
  for (int axis = 0; axis < 3; ++axis) {
    Vec3f step{};
    step[axis] = kStep;
    result[axis] = (integrals.at(p + step).phi - integrals.at(p - step).phi) / (2 * kStep);
  }
  return result;
}

TEST(BoundaryIntegrals, GradientIsThatOfPhi) {
  for (const Case& of : cases()) {
    const BoundaryIntegrals integrals = integralsOf(of.pieces);
    for (const Vec3f& p : pointsNear(of.pieces, 0.9f, 60)) {
      const Vec3f gradient = integrals.at(p).gradPhi, expected = differences(integrals, p);
      for (int axis = 0; axis < 3; ++axis)
        EXPECT_NEAR(gradient[axis] * kRadius, expected[axis] * kRadius, 0.02) << of.name;
    }
  }
}

TEST(BoundaryIntegrals, GradientIsThatOfPhiBesideAMesh) {
  CpuDevice device(1);
  std::vector<std::string> warnings;
  TriangleMesh ball;
  constexpr int kRings = 24;
  for (int ring = 0; ring <= kRings; ++ring)
    for (int k = 0; k < 2 * kRings; ++k) {
      const float a = std::numbers::pi_v<float> * float(ring) / kRings;
      const float b = std::numbers::pi_v<float> * float(k) / kRings;
      ball.vertices.push_back(0.2f *
                              Vec3f{std::sin(a) * std::cos(b), std::cos(a), std::sin(a) * std::sin(b)});
    }
  for (int ring = 0; ring < kRings; ++ring)
    for (int k = 0; k < 2 * kRings; ++k) {
      const int next = (k + 1) % (2 * kRings), low = ring * 2 * kRings, high = low + 2 * kRings;
      ball.triangles.push_back({low + k, low + next, high + k});
      ball.triangles.push_back({low + next, high + next, high + k});
    }
  const MeshSdf sdf(device, ball, 0.02f, 1.5f * kRadius, warnings);
  for (const bool outside : {false, true}) {
    BoundaryPiece piece;
    piece.isMesh = true;
    piece.mesh = sdf.view(outside);
    const std::vector<BoundaryPiece> pieces{piece};
    const BoundaryIntegrals integrals = integralsOf(pieces);
    std::mt19937 random(5);
    std::uniform_real_distribution<float> at(-0.25f, 0.25f);
    int near = 0;
    // Cells meet at kinks, so most of the points must fit, and all of them roughly.
    int off = 0;
    while (near < 100) {
      const Vec3f p{at(random), at(random), at(random)};
      if (std::fabs(piece.query(p).distance) > 0.9f * kRadius) continue;
      ++near;
      const Vec3f gradient = integrals.at(p).gradPhi, expected = differences(integrals, p);
      for (int axis = 0; axis < 3; ++axis) {
        const double error = std::fabs(gradient[axis] - expected[axis]) * kRadius;
        EXPECT_LT(error, 0.5);
        off += error > 0.02 ? 1 : 0;
      }
    }
    EXPECT_LT(off, 10);
  }
}

TEST(BoundaryIntegrals, OfSeveralPointsAreThoseOfEach) {
  for (const Case& of : cases()) {
    const BoundaryIntegrals integrals = integralsOf(of.pieces);
    const std::vector<Vec3f> points = pointsNear(of.pieces, 1.5f, 8);
    Vec3<Lanes> all;
    for (int lane = 0; lane < 8; ++lane) setLane(all, lane, points[std::size_t(lane)]);
    const auto together = integrals.at(all);
    for (int lane = 0; lane < 8; ++lane) {
      const SolidIntegrals<float> one = integrals.at(points[std::size_t(lane)]);
      EXPECT_EQ(laneOf(together.phi, lane), one.phi) << of.name;
      EXPECT_EQ(laneOf(together.gradPhi, lane), one.gradPhi) << of.name;
      EXPECT_EQ(laneOf(together.d, lane), one.d) << of.name;
    }
  }
}

TEST(BoundaryIntegrals, OneBoxIsFeltAsAmongOthers) {
  Shape unturned = kBox;
  unturned.rotation = {};
  for (const Shape& shape : {kBox, unturned, kPlate, inverted(kBox), inverted(unturned), inverted(kPlate)}) {
    const std::vector<BoundaryPiece> pieces{pieceOf(shape)};
    const BoundaryIntegrals all = integralsOf(pieces);
    ASSERT_TRUE(all.isOneBox());
    const BoxBoundary alone = all.oneBox();
    for (const Vec3f& p : pointsNear(pieces, 3, 1000)) {
      const SolidIntegrals<float> found = alone.at(p), expected = all.at(p);
      EXPECT_EQ(found.phi, expected.phi);
      EXPECT_EQ(found.gradPhi, expected.gradPhi);
      EXPECT_EQ(found.d, expected.d);
    }
  }
}

}  // namespace
}  // namespace weir::test
