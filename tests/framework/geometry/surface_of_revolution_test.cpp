// Volumes and areas against closed forms of the n-gons, walls against Pappus, and profiles that are wrong.
#include "framework/geometry/surface_of_revolution.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "tests/support/expect_error.h"

namespace weir::test {
namespace {

constexpr double kPi = std::numbers::pi;

using Profile = std::vector<Vec2f>;

Profile backwards(Profile p) {
  std::reverse(p.begin(), p.end());
  return p;
}

TriangleMesh turned(const Profile& profile, int segments, const RevolutionOptions& options = {}) {
  return surfaceOfRevolution(revolutionOutline(profile, options), segments);
}

/// The area of a regular n-gon in a circle of radius 1.
double polygonArea(int n) {
  return 0.5 * n * std::sin(2 * kPi / n);
}

/// The area of the side of a frustum with n-gons of circumradii a and b, h apart.
double frustumSide(int n, double a, double b, double h) {
  const double slant = std::hypot((b - a) * std::cos(kPi / n), h);
  return n * std::sin(kPi / n) * (a + b) * slant;
}

constexpr float kWall = 0.02f;

struct Body {
  const char* name;
  Profile profile;
  RevolutionOptions options;
};

/// One of each kind: with discs, points, both, holes, walls.
std::vector<Body> bodies() {
  Profile sphere;
  for (int k = 0; k <= 32; ++k)
    sphere.push_back({float(std::sin(kPi * k / 32)), float(-std::cos(kPi * k / 32))});
  const Profile goblet{{0, 0},          {0.16f, 0},     {0.17f, 0.012f}, {0.12f, 0.03f}, {0.045f, 0.05f},
                       {0.03f, 0.08f},  {0.03f, 0.2f},  {0.06f, 0.23f},  {0.15f, 0.29f}, {0.2f, 0.37f},
                       {0.22f, 0.47f},  {0.22f, 0.56f}, {0.2f, 0.56f},   {0.2f, 0.47f},  {0.18f, 0.38f},
                       {0.135f, 0.31f}, {0.05f, 0.26f}, {0, 0.255f}};
  return {{"cylinder", {{0.3f, -1}, {0.3f, 1}}, {}},
          {"cone", {{0.5f, 0}, {0, 2}}, {}},
          {"sphere", sphere, {}},
          {"ring", {{1, 0}, {1.5f, 0}, {1.2f, 0.6f}, {1, 0}}, {}},
          {"goblet", goblet, {}},
          {"pipe", {{0.3f, 0}, {0.3f, 1}}, {.thickness = kWall}},
          {"cup", {{0, 0}, {0.2f, 0}, {0.25f, 0.4f}}, {.thickness = kWall}},
          {"funnel", {{0.05f, 0}, {0.05f, 0.2f}, {0.4f, 0.6f}}, {.thickness = kWall}},
          {"bottle with a punt", {{0, 0.2f}, {0.2f, 0}, {0.2f, 0.5f}}, {.thickness = kWall}},
          {"disc", {{0, 0}, {1, 0}}, {.thickness = kWall}},
          {"spike", {{0, 0}, {0.1f, 2}}, {.thickness = 0.002f}}};
}

TEST(SurfaceOfRevolution, IsClosedAndFacesOutwardsWhicheverWayTheProfileRuns) {
  for (const Body& body : bodies())
    for (const int segments : {3, 4, 64})
      for (const Profile& profile : {body.profile, backwards(body.profile)}) {
        const TriangleMesh mesh = turned(profile, segments, body.options);
        EXPECT_EQ(diagnose(mesh).message(), "") << body.name << " of " << segments;
        EXPECT_GT(mesh.volume(), 0) << body.name;
        EXPECT_EQ(cleaned(mesh).vertices.size(), mesh.vertices.size()) << body.name << ": not welded";
      }
}

TEST(SurfaceOfRevolution, CylinderAndCone) {
  for (const int n : {3, 8, 64, 512}) {
    const TriangleMesh cylinder = turned({{0.3f, -1}, {0.3f, 1}}, n);
    EXPECT_NEAR(cylinder.volume() / (polygonArea(n) * 0.09 * 2), 1, 1e-6) << n;
    EXPECT_NEAR(cylinder.area() / (2 * polygonArea(n) * 0.09 + frustumSide(n, 0.3, 0.3, 2)), 1, 1e-6) << n;
    const TriangleMesh cone = turned({{0.5f, 0}, {0, 2}}, n);
    EXPECT_EQ(cone.vertices.size(), std::size_t(n) + 2);
    EXPECT_EQ(cone.triangles.size(), 2 * std::size_t(n));
    EXPECT_NEAR(cone.volume() / (polygonArea(n) * 0.25 * 2 / 3), 1, 1e-6) << n;
    EXPECT_NEAR(cone.area() / (polygonArea(n) * 0.25 + frustumSide(n, 0.5, 0, 2)), 1, 1e-6) << n;
  }
}

TEST(SurfaceOfRevolution, SphereConvergesWithBothResolutions) {
  double before = 1;
  for (const int n : {16, 32, 64, 128}) {
    Profile half;
    for (int k = 0; k <= n / 2; ++k)
      half.push_back({float(std::sin(2 * kPi * k / n)), float(-std::cos(2 * kPi * k / n))});
    const TriangleMesh mesh = turned(half, n);
    const double error = 1 - mesh.volume() / (4 * kPi / 3);
    EXPECT_GT(error, 0);
    EXPECT_NEAR(error / before, 0.25, n == 16 ? 1 : 0.01) << n;  // second order
    EXPECT_NEAR(mesh.area() / (4 * kPi), 1, 2 * error);
    before = error;
  }
}

/// ∫ 2π r over the polygon: the volume of a solid of revolution by Pappus, with the polygon closed along
/// the axis.
double pappus(const std::vector<Outline::Point>& p) {
  double sum = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const auto &a = p[i], &b = p[(i + 1) % p.size()];
    sum += (a.radius * b.height - b.radius * a.height) * (a.radius + b.radius) / 6;
  }
  return 2 * kPi * sum;
}

TEST(SurfaceOfRevolution, VolumesAreThoseOfPappusTimesTheFactorOfThePolygon) {
  for (const Body& body : bodies())
    for (const int n : {5, 64}) {
      const Outline outline = revolutionOutline(body.profile, body.options);
      EXPECT_NEAR(turned(body.profile, n, body.options).volume() / pappus(outline.points),
                  polygonArea(n) / kPi, 2e-6)
          << body.name;
    }
}

TEST(SurfaceOfRevolution, WallsHaveTheirThickness) {
  const double t = kWall;
  // A pipe.
  EXPECT_NEAR(pappus(revolutionOutline({{0.3f, 0}, {0.3f, 1}}, {.thickness = kWall}).points),
              kPi * (0.3 * 0.3 - (0.3 - t) * (0.3 - t)), 1e-7);
  // A straight cup: its bottom is as thick as its wall.
  EXPECT_NEAR(pappus(revolutionOutline({{0.2f, 0.4f}, {0.2f, 0}, {0, 0}}, {.thickness = kWall}).points),
              kPi * (0.2 * 0.2 * 0.4 - (0.2 - t) * (0.2 - t) * (0.4 - t)), 1e-7);
  // A hollow ball: a shell between two spheres.
  Profile ball;
  for (int k = 0; k <= 400; ++k)
    ball.push_back({float(std::sin(kPi * k / 400)), float(std::cos(kPi * k / 400))});
  EXPECT_NEAR(
      pappus(revolutionOutline(ball, {.thickness = 0.25f}).points) / (4 * kPi / 3 * (1 - 0.75 * 0.75 * 0.75)),
      1, 1e-4);
  // A disc gets its wall on its left, which is up for one that runs outwards.
  for (const auto& p : revolutionOutline({{0, 1}, {1, 1}}, {.thickness = kWall}).points)
    EXPECT_TRUE(p.height == 1 || std::abs(p.height - 1 - t) < 1e-7) << p.height;
}

/// The distance of a point from an open line.
double distance(const Outline::Point& q, const Profile& line) {
  double nearest = 1e30;
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const double ax = line[i].x, ay = line[i].y, dx = line[i + 1].x - ax, dy = line[i + 1].y - ay;
    const double s =
        std::clamp(((q.radius - ax) * dx + (q.height - ay) * dy) / (dx * dx + dy * dy), 0.0, 1.0);
    nearest = std::min(nearest, std::hypot(q.radius - ax - s * dx, q.height - ay - s * dy));
  }
  return nearest;
}

TEST(SurfaceOfRevolution, SharpCornersOfWallsAreBounded) {
  // The tip of the wedge points into the wall's inner side.
  const Profile wedge{{1, 0}, {0.5f, 0.02f}, {1, 0.04f}};
  const Outline outline = revolutionOutline(wedge, {.thickness = 0.1f});
  double farthest = 0;
  for (const auto& p : outline.points) farthest = std::max(farthest, distance(p, wedge));
  EXPECT_LE(farthest, 2 * 0.1 + 1e-9);
  EXPECT_GE(farthest, 0.1 - 1e-9);
}

TEST(SurfaceOfRevolution, WithoutCapsItIsOpen) {
  const TriangleMesh pipe = turned({{0.3f, 0}, {0.3f, 1}}, 16, {.caps = false});
  EXPECT_EQ(diagnose(pipe).openEdges, 32);
  EXPECT_EQ(pipe.triangles.size(), 32u);
  for (const Vec3i& t : pipe.triangles) {
    const Vec3f a = pipe.vertices[t.x];
    const Vec3f normal = cross(pipe.vertices[t.y] - a, pipe.vertices[t.z] - a);
    EXPECT_GT(normal.x * a.x + normal.z * a.z, 0);
  }
}

void expectRefusal(const Profile& profile, const RevolutionOptions& options, const std::string& part) {
  const Error e = errorOf([&] { revolutionOutline(profile, options); });
  EXPECT_EQ(e.kind(), ErrorKind::kScene);
  EXPECT_CONTAINS(e.what(), part);
}

TEST(SurfaceOfRevolution, WrongProfiles) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  expectRefusal({}, {}, "0 different points");
  expectRefusal({{1, 1}}, {}, "1 different points");
  expectRefusal({{1, 1}, {1, 1}}, {}, "1 different points");
  expectRefusal({{1, 0}, {-0.5f, 1}}, {}, "point 1 of the profile, [-0.5, 1], has a negative radius");
  expectRefusal({{1, nan}, {1, 1}}, {}, "point 0 of the profile is not finite");
  expectRefusal({{0, 0}, {0, 1}, {0, 2}}, {}, "on the axis");
  expectRefusal({{0, 0}, {1, 0}, {0, 1}, {1, 2}, {0, 2}}, {}, "touches the axis at [0, 1]");
  expectRefusal({{0, 0}, {1, 0}, {0, 0}}, {}, "same point of the axis");
  expectRefusal({{0, 0}, {1, 0}}, {}, "encloses no volume");
  expectRefusal({{0, 0}, {1, 0}, {0.2f, 1}, {1, 1}, {0.2f, 0.1f}, {0, 1}}, {}, "meets the line");
  expectRefusal({{0, 0}, {1, 0}, {1, 1}, {1, 0.5f}, {0, 2}}, {}, "meets the line");
  expectRefusal({{1, 0}, {1, 1}, {0.5f, 1}, {0.5f, -2}}, {}, "closed by a disc");
  expectRefusal(Profile(10001, {1, 0}), {}, "10001 points");
}

TEST(SurfaceOfRevolution, WallsThatDoNotFit) {
  expectRefusal({{0.3f, 0}, {0.3f, 1}}, {.thickness = 0.31f}, "across the axis");
  expectRefusal({{0, 0}, {0.2f, 0}, {0.2f, 0.1f}, {0.1f, 0.1f}}, {.thickness = 0.06f}, "bent too tightly");
  expectRefusal({{1, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 0}}, {.thickness = 0.1f}, "a wall already");
  // The two arms of a U, 0.1 apart, whose inside is between them.
  expectRefusal({{1, 1}, {1, 0}, {1.1f, 0}, {1.1f, 1}}, {.thickness = 0.06f}, "bent too tightly");
  expectRefusal({{0, 0}, {1, 0}, {1, 1}, {0.5f, 0.07f}}, {.thickness = 0.05f}, "runs into");
}

}  // namespace
}  // namespace weir::test
