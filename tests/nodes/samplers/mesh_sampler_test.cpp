// The inside of meshes against closed forms and ray counting.
#include "nodes/samplers/mesh_sampler.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "framework/geometry/surface_of_revolution.h"
#include "tests/nodes/samplers/sampled.h"
#include "tests/support/given_mesh.h"

namespace weir::test {
namespace {

class Filled : public Sampled<MeshSampler> {
 public:
  Filled(TriangleMesh mesh, float spacing, const Value& parameters = Value::object(), int threads = 0)
      : Sampled(parameters, spacing, "cpu", threads) {
    graph().add(std::make_unique<GivenMesh>(std::move(mesh)), "mesh");
    graph().link(SceneGraph::parseLink("mesh.surface -> block.surface"));
  }
};

TriangleMesh turned(const std::vector<Vec2f>& profile, const RevolutionOptions& options = {}) {
  TriangleMesh mesh = surfaceOfRevolution(revolutionOutline(profile, options), 48);
  mesh.transform(1, quaternionFromEulerDegrees({20, 30, 50}), {1, 2, 3});
  return mesh;
}

/// A wall of 10 cm between radii of 0.4 and 0.5 m, and a bottom: a bowl.
TriangleMesh bowl() {
  return turned({{0, 0}, {0.5f, 0}, {0.5f, 0.6f}}, {.thickness = 0.1f});
}

TriangleMesh box(const Vec3f& lo, const Vec3f& hi) {
  TriangleMesh mesh = surfaceOfRevolution(revolutionOutline({{1, -1}, {1, 1}}, {}), 4);
  // A cylinder of 4 steps has its corners at ±1 on x and z: an eighth of a turn makes it a box.
  mesh.transform(1, quaternionFromEulerDegrees({0, 45, 0}), {});
  const Vec3f center = 0.5f * (lo + hi), half = 0.5f * (hi - lo);
  for (Vec3f& v : mesh.vertices) {
    const float side = std::sqrt(2.0f);
    v = center + Vec3f{v.x * side * half.x, v.y * half.y, v.z * side * half.z};
  }
  return mesh;
}

/// Whether p is inside, by the triangles that a ray crosses, in double precision (Möller and Trumbore).
bool insideByRay(const TriangleMesh& mesh, const Vec3f& p) {
  const auto wide = [](const Vec3f& v) { return Vec3d{v.x, v.y, v.z}; };
  const Vec3d from = wide(p), along{0.2718281828, 0.5772156649, 0.7724538509};
  int crossings = 0;
  for (const Vec3i& t : mesh.triangles) {
    const Vec3d a = wide(mesh.vertices[t.x]);
    const Vec3d ab = wide(mesh.vertices[t.y]) - a, ac = wide(mesh.vertices[t.z]) - a;
    const Vec3d h = cross(along, ac), s = from - a, q = cross(s, ab);
    const double determinant = dot(ab, h);
    if (determinant == 0) continue;
    const double u = dot(s, h) / determinant, v = dot(along, q) / determinant;
    if (u >= 0 && v >= 0 && u + v <= 1 && dot(ac, q) / determinant > 0) ++crossings;
  }
  return crossings % 2 == 1;
}

TEST(MeshSampler, ABoxIsFilledLikeABoxSamplerFillsIt) {
  Filled filled(box({-0.5f, 1, 0.2f}, {0, 1.4f, 0.8f}), 0.1f);
  const std::vector<Vec3f> p = filled.positions();
  ASSERT_EQ(p.size(), 5u * 4 * 6);
  for (std::size_t i = 0; i < p.size(); ++i) {
    EXPECT_NEAR(p[i].x, -0.45 + 0.1 * double(i % 5), 1e-6);
    EXPECT_NEAR(p[i].y, 1.05 + 0.1 * double(i / 5 % 4), 1e-6);
    EXPECT_NEAR(p[i].z, 0.25 + 0.1 * double(i / 20), 1e-6);
  }
  EXPECT_TRUE(filled.warnings.empty());
}

TEST(MeshSampler, CountIsTheVolumeOverTheCubeOfTheSpacing) {
  for (const TriangleMesh& mesh : {bowl(), turned({{0.5f, 0}, {0, 2}})})
    for (const float spacing : {0.03f, 0.015f}) {
      const double expected = mesh.volume() / std::pow(double(spacing), 3);
      // A tenth of a layer on the surface is far more than the error of a lattice that lies askew.
      const double layer = mesh.area() / (double(spacing) * spacing);
      EXPECT_NEAR(double(Filled(mesh, spacing).positions().size()), expected, 0.1 * layer);
    }
}

TEST(MeshSampler, FlatSidesBetweenLayersDoNotChangeTheVolume) {
  const float d = 0.1f;
  const TriangleMesh cylinder =
      surfaceOfRevolution(revolutionOutline({{8.5f * d, 0}, {8.5f * d, 8.5f * d}}, {}), 96);
  for (const TriangleMesh& mesh : {box({0, 0, 0}, {8.5f * d, 8.5f * d, 8.5f * d}), cylinder}) {
    Filled filled(mesh, d);
    const double cubes = mesh.volume() / std::pow(double(d), 3);
    const std::size_t count = filled.positions().size();
    EXPECT_NEAR(double(count), cubes, 0.01 * cubes);
    filled.asker().disordered = true;
    for (const float ratio : {1.5f, 2.0f, 2.4f}) {
      filled.asker().supportRatio = ratio;
      EXPECT_EQ(filled.positions().size(), count);
    }
  }
}

TEST(MeshSampler, ParticlesAreInsideAndNoPlaceInsideIsEmpty) {
  const TriangleMesh mesh = bowl();
  const float spacing = 0.04f;
  const std::vector<Vec3f> p = Filled(mesh, spacing, object({{"jitter", 0.3}})).positions();
  for (const Vec3f& q : p) EXPECT_TRUE(insideByRay(mesh, q));

  // Monte Carlo: the share of random places in the bounds that are inside.
  std::mt19937 random(7);
  const Aabb bounds = mesh.bounds();
  std::uniform_real_distribution<float> unit(0, 1);
  constexpr int kTries = 20000;
  int inside = 0;
  for (int i = 0; i < kTries; ++i) {
    const Vec3f size = bounds.size();
    const Vec3f q = bounds.lo + Vec3f{unit(random) * size.x, unit(random) * size.y, unit(random) * size.z};
    inside += insideByRay(mesh, q) ? 1 : 0;
  }
  const Vec3f size = bounds.size();
  const double volume = double(inside) / kTries * size.x * size.y * size.z;
  EXPECT_NEAR(double(p.size()) * std::pow(double(spacing), 3) / volume, 1, 0.05);
}

TEST(MeshSampler, TheMarginKeepsParticlesFromTheSurface) {
  const double r = 0.5, h = 0.8, margin = 0.1, spacing = 0.03;
  TriangleMesh mesh = surfaceOfRevolution(revolutionOutline({{float(r), 0}, {float(r), float(h)}}, {}), 256);
  const std::vector<Vec3f> p = Filled(mesh, float(spacing), object({{"margin", margin}})).positions();
  for (const Vec3f& q : p) {
    EXPECT_LE(std::hypot(q.x, q.z), r - margin + 1e-4);
    EXPECT_GE(q.y, margin - 1e-5);
    EXPECT_LE(q.y, h - margin + 1e-5);
  }
  const double expected =
      std::numbers::pi * (r - margin) * (r - margin) * (h - 2 * margin) / std::pow(spacing, 3);
  EXPECT_NEAR(double(p.size()) / expected, 1, 0.07);
}

TEST(MeshSampler, FluidWithoutOrderKeepsItsCountAndItsDistanceFromTheSurface) {
  const TriangleMesh mesh = box({0, 0, 0}, {1, 0.8f, 0.6f});
  Filled filled(mesh, 0.05f);
  const std::size_t count = filled.positions().size();
  filled.asker().disordered = true;
  const std::vector<Vec3f> p = filled.positions();
  EXPECT_EQ(p.size(), count);
  for (const Vec3f& q : p) {
    EXPECT_GE(std::min({q.x, q.y, q.z}), 0.025 - 0.005);
    EXPECT_LE(std::max({q.x - 1, q.y - 0.8f, q.z - 0.6f}), -0.025 + 0.005);
  }
}

TEST(MeshSampler, MeshesWithFaultsAreFilledWithAWarning) {
  TriangleMesh turnedRound = bowl();
  const std::size_t right = Filled(turnedRound, 0.05f).positions().size();
  turnedRound.flip();
  Filled insideOut(turnedRound, 0.05f);
  EXPECT_EQ(insideOut.positions().size(), right);
  ASSERT_EQ(insideOut.warnings.size(), 1u);
  EXPECT_CONTAINS(insideOut.warnings[0], "inside out");

  TriangleMesh holed = bowl();
  holed.triangles.pop_back();
  Filled withHole(holed, 0.05f);
  EXPECT_NEAR(double(withHole.positions().size()), double(right), 0.02 * double(right));
  ASSERT_EQ(withHole.warnings.size(), 1u);
  EXPECT_CONTAINS(withHole.warnings[0], "mesh.surface");
  EXPECT_CONTAINS(withHole.warnings[0], "3 open edges");
}

TEST(MeshSampler, ResultsDoNotDependOnTheNumberOfThreads) {
  const Value jitter = object({{"jitter", 0.2}});
  EXPECT_EQ(Filled(bowl(), 0.02f, jitter, 1).positions(), Filled(bowl(), 0.02f, jitter, 4).positions());
}

TEST(MeshSampler, SaysWhatIsWrong) {
  Filled thin(bowl(), 0.02f, object({{"margin", 0.06}}));
  const Error none = errorOf([&] { thin.positions(); });
  EXPECT_EQ(none.kind(), ErrorKind::kScene);
  EXPECT_CONTAINS(none.what(), "no particle fits");
  EXPECT_EQ(none.location().node, "block");
  Filled empty({}, 0.02f);
  EXPECT_CONTAINS(errorOf([&] { empty.positions(); }).what(), "mesh.surface");
  Filled fine(bowl(), 1e-4f);
  EXPECT_CONTAINS(errorOf([&] { fine.positions(); }).what(), "at most 2147483647");
  SceneGraph graph;
  graph.add(std::make_unique<MeshSampler>(), "alone");
  EXPECT_CONTAINS(errorOf([&] { graph.validate(); }).what(), "alone.surface");
}

}  // namespace
}  // namespace weir::test
