// Integrals over solids against closed forms, and against quadrature of the volume with a test of what is
// inside.
#include "framework/solids/solid_integrals.h"
#include "framework/compute/dispatch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "framework/base/vec.h"
#include "tests/framework/solids/solid_integrals_kernel.h"
#include "tests/support/devices.h"
#include "tests/support/meshes.h"

namespace weir::test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kH = 0.012;  // m
constexpr double kFullD = 15 / (kH * kH);

using Integrals = SolidIntegrals<double>;

struct Corners {
  Vec3d a, b, c;
};
using Soup = std::vector<Corners>;

template <class T, class From>
Vec3<T> to(const Vec3<From>& v) {
  return {T(v.x), T(v.y), T(v.z)};
}

template <class T = double>
Integrals integrate(const Soup& soup, const Vec3d& p, bool insideWhenFar = false) {
  SolidIntegrator<T> solid(to<T>(p), T(kH));
  for (const Corners& t : soup) solid.addTriangle(to<T>(t.a), to<T>(t.b), to<T>(t.c));
  const SolidIntegrals<T> r = solid.integrals(1, insideWhenFar);
  return {r.phi, {r.gradPhi.x, r.gradPhi.y, r.gradPhi.z}, r.d};
}

/// The axes of a frame that is aligned with nothing, and its origin: where the tests put their solids.
struct Frame {
  Vec3d x, y, z, origin;
  Vec3d operator()(const Vec3d& p) const { return origin + x * p.x + y * p.y + z * p.z; }
};

Frame turnedFrame() {
  const Vec3d x = normalized(Vec3d{0.31, -0.77, 0.52});
  const Vec3d y = normalized(cross(Vec3d{0.2, 0.4, -0.6}, x));
  return {x, y, cross(x, y), {0.4, -0.3, 0.7}};
}

Frame straightFrame() {
  return {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {}};
}

/// The cube [−size, 0]³ in the frame, with its corner at the origin; solid within, or without if it is a
/// room.
Soup cubeSoup(const Frame& frame, double size, bool room) {
  Vec3d corner[8];
  for (int i = 0; i < 8; ++i) corner[i] = frame({i & 1 ? 0 : -size, i & 2 ? 0 : -size, i & 4 ? 0 : -size});
  const int faces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                           {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  Soup soup;
  for (const auto& f : faces) {
    soup.push_back({corner[f[0]], corner[f[1]], corner[f[2]]});
    soup.push_back({corner[f[0]], corner[f[2]], corner[f[3]]});
  }
  if (room)
    for (Corners& t : soup) std::swap(t.b, t.c);
  return soup;
}

Soup divided(const Soup& soup) {
  Soup result;
  for (const auto& [a, b, c] : soup) {
    const Vec3d ab = (a + b) * 0.5, bc = (b + c) * 0.5, ca = (c + a) * 0.5;
    result.insert(result.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
  }
  return result;
}

/// A square in the plane z = 0, far larger than the support, with fluid above.
Soup floorSoup(double size) {
  const Vec3d a{-size, -size, 0}, b{size, -size, 0}, c{size, size, 0}, d{-size, size, 0};
  return divided({{a, b, c}, {a, c, d}});
}

double kernel(double r) {
  return r < kH ? 15 / (kPi * std::pow(kH, 3)) * std::pow(1 - r / kH, 3) : 0;
}
double slopeOverR(double r) {
  return r < kH ? 45 / (kPi * std::pow(kH, 4)) * std::pow(1 - r / kH, 2) / r : 0;
}

/// ∫_a^b f(x) dx by many midpoints.
template <class F>
double midpoints(double a, double b, F f, int count = 20000) {
  double sum = 0;
  for (int i = 0; i < count; ++i) sum += f(a + (b - a) * (i + 0.5) / count);
  return sum * (b - a) / count;
}

/// ∫_0^r f(z) z² dz of both kernels, tabled.
class RadialTable {
 public:
  RadialTable() {
    for (int i = 0; i < kCount; ++i) {
      const double r = kH * (i + 0.5) / kCount, rr = r * r * kH / kCount;
      phi_[i + 1] = phi_[i] + kernel(r) * rr;
      d_[i + 1] = d_[i] + slopeOverR(r) * rr;
    }
  }
  double phi(double r) const { return read(phi_, r); }
  double d(double r) const { return read(d_, r); }

 private:
  static constexpr int kCount = 4000;
  static double read(const std::vector<double>& table, double r) {
    const double at = std::min(r / kH, 1.0) * kCount;
    const int i = std::min(static_cast<int>(at), kCount - 1);
    return table[i] + (at - i) * (table[i + 1] - table[i]);
  }
  std::vector<double> phi_ = std::vector<double>(kCount + 1), d_ = phi_;
};

/// Φ and D of the octant x, y, z < 0 for a particle at p, both over those of a full ball: along each of many
/// directions the ray from p is in the octant between two distances.
Integrals octantByRays(const RadialTable& radial, const Vec3d& p) {
  constexpr int kPolar = 160, kAround = 320;
  Integrals sum;
  for (int i = 0; i < kPolar; ++i) {
    const double z = -1 + (i + 0.5) * 2 / kPolar, ring = std::sqrt(1 - z * z);
    for (int k = 0; k < kAround; ++k) {
      const double angle = (k + 0.5) * 2 * kPi / kAround;
      const Vec3d ray{ring * std::cos(angle), ring * std::sin(angle), z};
      double from = 0, to = kH;
      for (int axis = 0; axis < 3; ++axis) {
        const double hit = -p[axis] / ray[axis];
        if (ray[axis] > 0) to = std::min(to, hit);
        if (ray[axis] < 0) from = std::max(from, hit);
      }
      if (from < to) {
        sum.phi += radial.phi(to) - radial.phi(from);
        sum.d += radial.d(to) - radial.d(from);
      }
    }
  }
  const double rays = kPolar * kAround;
  return {sum.phi / rays / radial.phi(kH), {}, sum.d / rays / radial.d(kH)};
}

std::vector<Vec3d> randomPoints(int count, double reach, unsigned seed = 5) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> coordinate(-reach, reach);
  std::vector<Vec3d> points;
  for (int i = 0; i < count; ++i)
    points.push_back({coordinate(random), coordinate(random), coordinate(random)});
  return points;
}

TEST(SolidIntegrals, OfAHalfSpaceAreTheClosedForms) {
  const Soup soup = floorSoup(0.1);
  for (int i = 0; i <= 100; ++i) {
    const double q = i / 100.0, delta = q * kH;
    const double phi =
        0.5 - 1.5 * q + 5 * std::pow(q, 3) - 7.5 * std::pow(q, 4) + 4.5 * std::pow(q, 5) - std::pow(q, 6);
    // The cap of the sphere of radius r beyond the plane has the solid angle 2π·(1 − δ/r).
    const double d =
        midpoints(delta, kH, [&](double r) { return slopeOverR(r) * r * r * 2 * kPi * (1 - delta / r); });
    const double flux = midpoints(delta, kH, [&](double r) { return kernel(r) * 2 * kPi * r; });

    const Integrals outside = integrate(soup, {0.0013, -0.0021, delta});
    EXPECT_NEAR(outside.phi, phi, 1e-5) << q;
    EXPECT_NEAR(outside.d, d, 1e-4 * kFullD) << q;
    EXPECT_NEAR(outside.gradPhi.z, -flux, 1e-4 / kH) << q;
    EXPECT_NEAR(std::hypot(outside.gradPhi.x, outside.gradPhi.y), 0, 1e-9 / kH);

    const Integrals inside = integrate(soup, {0.0013, -0.0021, -delta}, true);
    EXPECT_NEAR(inside.phi, 1 - phi, 1e-5) << q;
    EXPECT_NEAR(inside.d, kFullD - d, 1e-4 * kFullD) << q;
    EXPECT_NEAR(inside.gradPhi.z, -flux, 1e-4 / kH) << q;
  }
}

TEST(SolidIntegrals, ScaleWithTheCalibration) {
  SolidIntegrator<double> solid({0, 0, 0.3 * kH}, kH);
  for (const Corners& t : floorSoup(0.1)) solid.addTriangle(t.a, t.b, t.c);
  const Integrals one = solid.integrals(1), scaled = solid.integrals(0.35);
  EXPECT_DOUBLE_EQ(scaled.phi, 0.35 * one.phi);
  EXPECT_DOUBLE_EQ(scaled.d, 0.35 * one.d);
  EXPECT_DOUBLE_EQ(scaled.gradPhi.z, 0.35 * one.gradPhi.z);
}

/// 200 particles on both sides of a corner, for both precisions.
template <class T>
void expectCornerAsByRays(bool room, double tolerance) {
  const RadialTable radial;
  const Frame frame = turnedFrame();
  const Soup soup = cubeSoup(frame, 0.05, room);
  for (const Vec3d& local : randomPoints(200, 0.9 * kH)) {
    const Integrals inOctant = octantByRays(radial, local);
    const double phi = room ? 1 - inOctant.phi : inOctant.phi, d = room ? 1 - inOctant.d : inOctant.d;
    const bool inside = (local.x < 0 && local.y < 0 && local.z < 0) != room;
    const Integrals found = integrate<T>(soup, frame(local), inside);
    EXPECT_NEAR(found.phi, phi, tolerance) << local.x << ' ' << local.y << ' ' << local.z;
    EXPECT_NEAR(found.d / kFullD, d, tolerance) << local.x << ' ' << local.y << ' ' << local.z;
  }
}

TEST(SolidIntegrals, AtAConvexCornerAreTheVolumeIntegrals) {
  expectCornerAsByRays<double>(false, 0.001);
  expectCornerAsByRays<float>(false, 0.001);
}

TEST(SolidIntegrals, AtAConcaveCornerAreTheVolumeIntegrals) {
  expectCornerAsByRays<double>(true, 0.001);
  expectCornerAsByRays<float>(true, 0.001);
}

TEST(SolidIntegrals, GradientIsThatOfPhi) {
  const Frame frame = turnedFrame();
  for (const bool room : {false, true}) {
    const Soup soup = cubeSoup(frame, 0.05, room);
    for (const Vec3d& local : randomPoints(200, 0.9 * kH)) {
      const Vec3d p = frame(local);
      const double h = 1e-4 * kH;
      Vec3d slope;
      for (int axis = 0; axis < 3; ++axis) {
        Vec3d step;
        step[axis] = h;
        slope[axis] = (integrate(soup, p + step).phi - integrate(soup, p - step).phi) / (2 * h);
      }
      // 1 % of itself; where it is small, a thousandth of its largest value near a wall.
      const double allowed = std::max(0.01 * length(slope), 0.0015 / kH);
      EXPECT_LT(length(integrate(soup, p).gradPhi - slope), allowed)
          << local.x << ' ' << local.y << ' ' << local.z;
    }
  }
}

SymmetricTensorOf<double> curvatureOf(const Soup& soup, const Vec3d& p, bool isSheet = false) {
  SolidIntegrator<double> solid(p, kH, isSheet);
  for (const Corners& t : soup) solid.addTriangle(t.a, t.b, t.c);
  return solid.curvature(1);
}

TEST(SolidIntegrals, CurvatureOfAHalfSpaceIsTheClosedForm) {
  const Frame frame = turnedFrame();
  const Soup soup = cubeSoup(frame, 4 * kH, false);
  for (const double q : {0.05, 0.25, 0.5, 0.9}) {
    const Vec3d p = frame({q * kH, -2 * kH, -2 * kH});
    const double expected = 30 * q * std::pow(1 - q, 3) / (kH * kH);
    for (const Vec3d& along : {frame.x, frame.y, normalized(frame.x + frame.y)}) {
      const double cosine = dot(along, frame.x);
      EXPECT_NEAR(dot(along, curvatureOf(soup, p) * along), cosine * cosine * expected, 1e-6 * expected) << q;
    }
    // A sheet has it on both sides, what is behind a face of a solid has none.
    const Vec3d behind = frame({-q * kH, -2 * kH, -2 * kH});
    EXPECT_NEAR(dot(frame.x, curvatureOf(soup, behind, true) * frame.x), expected, 1e-6 * expected) << q;
    EXPECT_EQ(dot(frame.x, curvatureOf(soup, behind) * frame.x), 0) << q;
  }
}

// In the edges and corners of a room, across its faces: as ∇Φ changes, but for what one face shows less of
// the nearer the other is.
TEST(SolidIntegrals, CurvatureIsHowTheGradientChangesAcrossTheFacesOfARoom) {
  const Frame frame = turnedFrame();
  const Soup soup = cubeSoup(frame, 0.05, true);
  double worst = 0;
  for (const double a : {0.15, 0.25, 0.4})
    for (const double b : {0.15, 0.25, 0.4, 2.0})
      for (const double c : {0.25, 2.0}) {
        const Vec3d p = frame(Vec3d{-a, -b, -c} * kH);
        const double h = 1e-4 * kH;
        const double changes = dot(frame.x, integrate(soup, p + h * frame.x).gradPhi -
                                                integrate(soup, p - h * frame.x).gradPhi) /
                               (2 * h);
        const double found = dot(frame.x, curvatureOf(soup, p) * frame.x);
        worst = std::max(worst, std::abs(found / changes - 1));
        // Never less than nothing, in any direction.
        for (const Vec3d& along : randomPoints(20, 1))
          EXPECT_GE(dot(along, curvatureOf(soup, p) * along), -1e-9 * found);
      }
  EXPECT_LT(worst, 0.08);
}

struct Place {
  const char* name;
  Vec3d local;
  double fraction;  ///< of the support that is solid: no other faces are within reach
};

const Place kPlaces[] = {{"face", {-1.9 * kH, 0, -1.1 * kH}, 0.5},
                         {"diagonal of a face", {-1.5 * kH, -1.5 * kH, 0}, 0.5},
                         {"edge", {0, 0, -1.3 * kH}, 0.25},
                         {"another edge", {-2 * kH, 0, 0}, 0.25},
                         {"corner", {0, 0, 0}, 0.125}};

TEST(SolidIntegrals, OnTheSurfaceAreExact) {
  for (const Frame& frame : {straightFrame(), turnedFrame()}) {
    for (const bool room : {false, true}) {
      const Soup soup = cubeSoup(frame, 0.1, room);
      for (const Place& place : kPlaces) {
        const double solid = room ? 1 - place.fraction : place.fraction;
        const Integrals found = integrate(soup, frame(place.local));
        EXPECT_NEAR(found.phi, solid, 1e-5) << place.name;
        EXPECT_NEAR(found.d / kFullD, solid, 1e-4) << place.name;
      }
    }
  }
}

/// Φ, D and ∇Φ may change by what their slopes allow (Φ: 3/2 an H, D: 4, ∇Φ: 5) and by rounding.
template <class T>
void expectContinuous(double rounding) {
  for (const Frame& frame : {straightFrame(), turnedFrame()}) {
    for (const bool room : {false, true}) {
      const Soup soup = cubeSoup(frame, 0.1, room);
      for (const Place& place : kPlaces) {
        const Integrals at = integrate<T>(soup, frame(place.local));
        EXPECT_TRUE(std::isfinite(at.phi) && std::isfinite(at.d) && std::isfinite(length(at.gradPhi)));
        for (const double distance : {1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-10})
          for (const Vec3d& direction : randomPoints(40, 1)) {
            const Integrals near =
                integrate<T>(soup, frame(place.local + normalized(direction) * (distance * kH)));
            const double allowed = 8 * distance + rounding;
            EXPECT_NEAR(near.phi, at.phi, allowed) << place.name << " at " << distance;
            EXPECT_NEAR(near.d / kFullD, at.d / kFullD, allowed) << place.name << " at " << distance;
            EXPECT_LT(length(near.gradPhi - at.gradPhi) * kH, allowed) << place.name << " at " << distance;
          }
      }
    }
  }
}

TEST(SolidIntegrals, AreContinuousAcrossFacesEdgesAndCorners) {
  expectContinuous<double>(1e-4);
}

TEST(SolidIntegrals, AreContinuousInFloat) {
  expectContinuous<float>(2e-3);
}

/// Compares particles on corners and edges of the mesh with particles beside them.
void expectOnEdgesAsBeside(const TriangleMesh& mesh, const Vec3f& center) {
  Soup soup;
  for (const Vec3i& t : mesh.triangles) {
    const auto corner = [&](int k) { return to<double>(center + mesh.vertices[t[k]]); };
    soup.push_back({corner(0), corner(1), corner(2)});
  }
  std::mt19937 random(7);
  std::uniform_real_distribution<double> fraction(0, 1);
  for (std::size_t i = 0; i < 3000; ++i) {
    const Corners& t = soup[i % soup.size()];
    const Vec3d onEdge = to<double>(to<float>(i < 300 ? t.a : t.a + (t.b - t.a) * fraction(random)));
    const Integrals beside = integrate(soup, onEdge + Vec3d{0.5, -0.6, 0.3} * (1e-4 * kH));
    for (const Integrals& found : {integrate(soup, onEdge), integrate<float>(soup, onEdge)}) {
      ASSERT_NEAR(found.phi, beside.phi, 5e-4) << i;
      ASSERT_NEAR(found.d / kFullD, beside.d / kFullD, 5e-4) << i;
      ASSERT_LT(length(found.gradPhi - beside.gradPhi) * kH, 1e-3) << i;
    }
  }
}

TEST(SolidIntegrals, OnTheEdgesOfAnIcosphereAreThoseBesideThem) {
  for (const Vec3f& center : {Vec3f{}, Vec3f{0.3f, -0.2f, 0.1f}})
    expectOnEdgesAsBeside(icosphere(1, static_cast<float>(2 * kH)), center);
}

/// Along its edges two coordinates change alike, so that particles lie on them to the last digit.
TEST(SolidIntegrals, OnTheEdgesOfAnOctahedronAreThoseBesideThem) {
  TriangleMesh mesh;
  const float r = static_cast<float>(1.5 * kH);
  mesh.vertices = {{r, 0, 0}, {-r, 0, 0}, {0, r, 0}, {0, -r, 0}, {0, 0, r}, {0, 0, -r}};
  for (int x = 0; x < 2; ++x)
    for (int y = 2; y < 4; ++y)
      for (int z = 4; z < 6; ++z)
        mesh.triangles.push_back((x + y + z) % 2 == 0 ? Vec3i{x, y, z} : Vec3i{x, z, y});
  ASSERT_GT(mesh.volume(), 0);
  for (const Vec3f& center : {Vec3f{}, Vec3f{0.25f, -0.5f, 0.125f}}) expectOnEdgesAsBeside(mesh, center);
}

TEST(SolidIntegrals, InFloatAreThoseInDouble) {
  const Frame frame = turnedFrame();
  for (const bool room : {false, true}) {
    const Soup soup = divided(cubeSoup(frame, 0.05, room));
    for (const Vec3d& local : randomPoints(1000, 1.2 * kH)) {
      const Vec3d p = frame(local);
      const bool inside = (local.x < 0 && local.y < 0 && local.z < 0) != room;
      const Integrals exact = integrate(soup, p, inside), found = integrate<float>(soup, p, inside);
      // Coordinates near 1 m are rounded by 5e-6·H.
      EXPECT_NEAR(found.phi, exact.phi, 3e-5);
      EXPECT_NEAR(found.d / kFullD, exact.d / kFullD, 5e-5);
      EXPECT_LT(length(found.gradPhi - exact.gradPhi) * kH, 1e-4);
    }
  }
}

TEST(SolidIntegrals, DoNotDependOnTheTriangles) {
  const Frame frame = turnedFrame();
  for (const bool room : {false, true}) {
    const Soup coarse = cubeSoup(frame, 0.05, room);
    const Soup fine = divided(divided(divided(divided(coarse))));
    for (const Vec3d& local : randomPoints(100, 1.1 * kH)) {
      const Integrals a = integrate(coarse, frame(local)), b = integrate(fine, frame(local));
      EXPECT_NEAR(a.phi, b.phi, 2e-6);
      EXPECT_NEAR(a.d / kFullD, b.d / kFullD, 2e-4);
      EXPECT_LT(length(a.gradPhi - b.gradPhi) * kH, 2e-4);
    }
  }
}

/// Each triangle cut into `count` slivers from its first corner.
Soup slivers(const Soup& soup, int count) {
  Soup result;
  for (const auto& [a, b, c] : soup)
    for (int i = 0; i < count; ++i)
      result.push_back({a, b + (c - b) * (double(i) / count), b + (c - b) * (double(i + 1) / count)});
  return result;
}

template <class T>
void expectOfFineTrianglesAsOfLargeOnes(const Soup& coarse, const Soup& fine, const Frame& frame, bool room) {
  for (const Vec3d& local : randomPoints(150, 1.2 * kH, 23)) {
    const Vec3d p = frame(local);
    const bool inside = (local.x < 0 && local.y < 0 && local.z < 0) != room;
    const Integrals a = integrate(coarse, p, inside), b = integrate<T>(fine, p, inside);
    EXPECT_NEAR(a.phi, b.phi, 1e-5) << local.x << ' ' << local.y << ' ' << local.z;
    EXPECT_NEAR(a.d / kFullD, b.d / kFullD, 2e-4);
    EXPECT_LT(length(a.gradPhi - b.gradPhi) * kH, 2e-4);
  }
}

/// Slivers and small triangles are summed by points inside them.
TEST(SolidIntegrals, OfSliversAreThoseOfLargeTriangles) {
  const Frame frame = turnedFrame();
  for (const bool room : {false, true})
    for (const int count : {8, 14, 25, 100}) {
      const Soup coarse = cubeSoup(frame, 0.05, room), fine = slivers(divided(coarse), count);
      expectOfFineTrianglesAsOfLargeOnes<float>(coarse, fine, frame, room);
      expectOfFineTrianglesAsOfLargeOnes<double>(coarse, fine, frame, room);
    }
}

TEST(SolidIntegrals, OfSmallTrianglesAreThoseOfLargeOnes) {
  const Frame frame = turnedFrame();
  const Soup coarse = cubeSoup(frame, 0.02, false),
             fine = divided(divided(divided(divided(divided(coarse)))));
  expectOfFineTrianglesAsOfLargeOnes<float>(coarse, fine, frame, false);
}

/// The sums of both faces cancel but for a rest that must not have the wrong sign.
TEST(SolidIntegrals, OfAThinPlateOfSliversAreThoseOfTwoHalfSpaces) {
  const auto half = [](double q) { return 0.5 * std::pow(1 - q, 5) * (1 + 2 * q); };
  const Soup front = slivers(floorSoup(0.05), 300);
  for (const double thickness : {0.1, 0.001, 0.0}) {
    Soup plate = front;
    for (Corners t : front) {
      for (Vec3d* corner : {&t.a, &t.b, &t.c}) corner->z = -thickness * kH;
      plate.push_back({t.a, t.c, t.b});
    }
    for (const double q : {0.35, 0.45, 0.6, 0.8, 0.95}) {
      const Integrals found = integrate<float>(plate, {0.0013, -0.0021, q * kH});
      EXPECT_NEAR(found.phi, half(q) - half(q + thickness), 1e-5) << q << ", " << thickness;
    }
  }
}

TEST(SolidIntegrals, OfASolidOutOfReachAreZeroOrFull) {
  const Soup soup = cubeSoup(straightFrame(), 0.1, false);
  for (const Vec3d& p :
       {Vec3d{1.01 * kH, -0.05, -0.05}, Vec3d{0.8 * kH, 0.8 * kH, 0.8 * kH}, Vec3d{5, 6, 7}}) {
    const Integrals found = integrate(soup, p);
    EXPECT_EQ(found.phi, 0);
    EXPECT_EQ(found.d, 0);
    EXPECT_EQ(length(found.gradPhi), 0);
  }
  const Integrals deep = integrate(soup, {-0.05, -0.05, -0.05}, true);
  EXPECT_DOUBLE_EQ(deep.phi, 1);
  EXPECT_DOUBLE_EQ(deep.d, kFullD);
}

TEST(SolidIntegrals, OfATriangleWithoutAreaAreZero) {
  const Vec3d a{0, 0, 0}, b{kH, 0, 0};
  for (const Corners& t : {Corners{a, a, a}, Corners{a, a, b}, Corners{a, b, b}, Corners{a, b, b * 0.5}}) {
    const Integrals found = integrate({t}, {0.1 * kH, 0, 0.1 * kH});
    EXPECT_EQ(found.phi, 0);
    EXPECT_EQ(found.d, 0);
    EXPECT_EQ(length(found.gradPhi), 0);
  }
}

/// A thin wall and a thin gap: both sides of the surface are near, the sign must still be right.
TEST(SolidIntegrals, OfAThinPlateAreThoseOfTwoHalfSpaces) {
  const auto half = [](double q) { return 0.5 * std::pow(1 - q, 5) * (1 + 2 * q); };
  for (const double thickness : {0.5, 0.1, 0.01, 0.001}) {
    Soup plate = floorSoup(0.1);
    for (Corners t : floorSoup(0.1)) {
      for (Vec3d* corner : {&t.a, &t.b, &t.c}) corner->z = -thickness * kH;
      plate.push_back({t.a, t.c, t.b});
    }
    for (const double q : {0.0, 0.1, 0.4}) {
      const Integrals found = integrate<float>(plate, {0.0013, -0.0021, q * kH});
      EXPECT_NEAR(found.phi, half(q) - half(q + thickness), 2e-5);
    }
    const Integrals middle = integrate<float>(plate, {0.0013, -0.0021, -0.5 * thickness * kH});
    EXPECT_NEAR(middle.phi, 1 - 2 * half(0.5 * thickness), 2e-5);
  }
}

/// What thin parts hide counts as solid.
Integrals filled(const Soup& soup, const Vec3d& p) {
  SolidIntegrator<double> solid(p, kH);
  for (const Corners& t : soup) solid.addTriangle(t.a, t.b, t.c);
  EXPECT_TRUE(solid.isOutside());
  for (const Corners& t : soup) solid.fillBehind(t.a, t.b, t.c);
  return solid.integrals(1);
}

Soup plateSoup(double size, double thickness) {
  Soup plate = floorSoup(size);
  for (Corners t : floorSoup(size)) {
    for (Vec3d* corner : {&t.a, &t.b, &t.c}) corner->z = -thickness;
    plate.push_back({t.a, t.c, t.b});
  }
  return plate;
}

TEST(SolidIntegrals, BehindAThinPlateAllIsSolid) {
  const Soup floor = floorSoup(0.1);
  for (const double thickness : {0.9, 0.5, 0.1, 0.001}) {
    const Soup plate = plateSoup(0.1, thickness * kH);
    for (const double q : {0.1, 0.4, 0.8}) {
      const Vec3d p{0.0013, -0.0021, q * kH};
      const Integrals found = filled(plate, p), half = integrate(floor, p);
      EXPECT_NEAR(found.phi, half.phi, 1e-12) << thickness << " " << q;
      EXPECT_NEAR(found.d / kFullD, half.d / kFullD, 1e-12);
      EXPECT_LT(length(found.gradPhi - half.gradPhi) * kH, 1e-12);
    }
  }
}

/// A wall that stands on a floor and is one mesh with it, seen from the corner between the two.
TEST(SolidIntegrals, BehindAThinWallOnAFloorAllIsSolid) {
  const double thickness = 0.2 * kH;
  const auto box = [](const Vec3d& lo, const Vec3d& hi) {
    Soup soup = cubeSoup(straightFrame(), 1, false);
    for (Corners& t : soup)
      for (Vec3d* c : {&t.a, &t.b, &t.c})
        *c = {c->x < -0.5 ? lo.x : hi.x, c->y < -0.5 ? lo.y : hi.y, c->z < -0.5 ? lo.z : hi.z};
    return soup;
  };
  const Soup wall = box({-thickness, 0, -0.1}, {0, 0.1, 0.1}), block = box({-0.1, -0.1, -0.1}, {0, 0.1, 0.1});
  // The ground on this side of the wall only, which sees it end there.
  const Soup near = box({0, -0.1, -0.1}, {0.1, 0, 0.1});
  for (const Vec3d& p : {Vec3d{0.3, 0.1, 0} * kH, Vec3d{0.3, 0.3, 0} * kH, Vec3d{0.8, 0.2, 0} * kH}) {
    Soup both = near;
    both.insert(both.end(), wall.begin(), wall.end());
    const Integrals found = filled(both, p);
    const Integrals expected = [&] {
      const Integrals a = integrate(block, p), b = integrate(near, p);
      return Integrals{a.phi + b.phi, a.gradPhi + b.gradPhi, a.d + b.d};
    }();
    EXPECT_NEAR(found.phi, expected.phi, 0.01);
    EXPECT_LT(length(found.gradPhi - expected.gradPhi) * kH, 0.02);
  }
}

/// Nothing changes at solids whose backs, if they are in reach, are not the other side of a thin part.
TEST(SolidIntegrals, OfBlocksAreTheSameWithWhatIsBehind) {
  const Frame frame = turnedFrame();
  for (const bool room : {false, true}) {
    const Soup soup = divided(cubeSoup(frame, 0.05, room));
    for (const Vec3d& local : randomPoints(300, 1.2 * kH)) {
      if ((local.x < 0 && local.y < 0 && local.z < 0) != room) continue;
      const Integrals exact = integrate(soup, frame(local)), found = filled(soup, frame(local));
      EXPECT_NEAR(found.phi, exact.phi, 1e-12);
      EXPECT_NEAR(found.d / kFullD, exact.d / kFullD, 1e-12);
      EXPECT_LT(length(found.gradPhi - exact.gradPhi) * kH, 1e-12);
    }
  }
}

TEST(SolidIntegrals, ByThePublishedApproximationAreConesBeyondThePlane) {
  const Soup soup = floorSoup(100);  // so large that it fills half of all directions
  for (const double q : {0.1, 0.2, 0.4, 0.7}) {
    SolidIntegrator<double> solid({0.0013, -0.0021, q * kH}, kH);
    for (const Corners& t : soup) solid.addTriangleApproximately(t.a, t.b, t.c);
    const Integrals found = solid.integrals(1);
    const auto tail = [&](auto f) { return midpoints(q * kH, kH, [&](double r) { return f(r) * r * r; }); };
    EXPECT_NEAR(found.phi, 2 * kPi * tail(kernel), 1e-3);
    EXPECT_NEAR(found.d / kFullD, 2 * kPi * tail(slopeOverR) / kFullD, 1e-3);
    // The mean of r̂ over half of all directions is half a normal.
    EXPECT_NEAR(found.gradPhi.z * kH, -kPi * tail([](double r) { return slopeOverR(r) * r; }) * kH, 1e-3);

    const double exact = integrate(soup, {0.0013, -0.0021, q * kH}).phi;
    EXPECT_NEAR(found.phi / exact, (1 + 4 * q + 10 * q * q) / ((1 - q) * (1 + 2 * q)), 0.05);
  }
}

using SolidIntegralsOnDevice = OnDevice;

TEST_P(SolidIntegralsOnDevice, AreThoseInDouble) {
  const Frame frame = turnedFrame();
  const Soup soup = cubeSoup(frame, 0.05, false);
  std::vector<Vec3f> corners, points;
  for (const Corners& t : soup)
    corners.insert(corners.end(), {to<float>(t.a), to<float>(t.b), to<float>(t.c)});
  for (const Vec3d& local : randomPoints(300, 0.7 * kH)) points.push_back(to<float>(frame(local)));
  for (const Place& place : kPlaces) points.push_back(to<float>(frame(place.local)));

  const Array<Vec3f> triangles(*device, corners), asked(*device, points);
  Array<SolidIntegrals<float>> found(*device, asked.size());
  dispatch(*device, [&](auto& backend) {
    integrateAll(backend, static_cast<float>(kH), triangles.view(), asked.view(), found.view());
  });
  const std::vector<SolidIntegrals<float>> results = found.toHost();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3d p{points[i].x, points[i].y, points[i].z};
    const Integrals exact = integrate(soup, p);
    EXPECT_NEAR(results[i].phi, exact.phi, 1e-4) << i;
    EXPECT_NEAR(results[i].d / kFullD, exact.d / kFullD, 1e-4) << i;
    EXPECT_NEAR(results[i].gradPhi.x * kH, exact.gradPhi.x * kH, 2e-4) << i;
  }
}

WEIR_ON_EVERY_DEVICE(SolidIntegralsOnDevice);

}  // namespace
}  // namespace weir::test
