#include "nodes/fluid_surface/fluid_surface.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <cstdio>

#include "nodes/fluid_surface/surface_level.h"
#include "tests/nodes/fluid_surface/host_mesh.h"
#include "tests/support/devices.h"
#include "tests/support/fluid_scene.h"
#include "tests/support/simulated_scene.h"

namespace weir {
namespace {

constexpr float kSpacing = 0.02f;

/// The surface of given particles.
class SurfaceScene {
 public:
  SurfaceScene(Device& device, const std::vector<Vec3f>& positions, const Value& parameters = Value::object())
      : scene_(device, positions, {}, test::object({{"spacing", double(kSpacing)}})) {
    node_ = static_cast<FluidSurface*>(&scene_.graph().add(std::make_unique<FluidSurface>(), "surface"));
    node_->assignAll(parameters, {"test", "", ""});
    scene_.graph().link(SceneGraph::parseLink("water.fluid -> surface.fluid"));
    scene_.reset(1e-3);
    scene_.frame();
  }

  TriangleMesh mesh() const { return test::onHost(*node_->surface); }
  FluidSurface& node() { return *node_; }

 private:
  test::FluidScene scene_;
  FluidSurface* node_;
};

std::vector<Vec3f> ball(float radius, const Vec3f& center) {
  std::vector<Vec3f> all;
  const int n = static_cast<int>(radius / kSpacing) + 1;
  for (int z = -n; z <= n; ++z)
    for (int y = -n; y <= n; ++y)
      for (int x = -n; x <= n; ++x) {
        const Vec3f p = kSpacing * Vec3f{float(x), float(y), float(z)};
        if (length(p) <= radius) all.push_back(center + p);
      }
  return all;
}

double volumeOfBall(double radius) {
  return 4.0 / 3 * M_PI * std::pow(radius, 3);
}

void expectGood(const TriangleMesh& mesh) {
  const MeshDiagnosis diagnosis = diagnose(mesh);
  EXPECT_TRUE(diagnosis.good()) << diagnosis.message();
}

using FluidSurfaceTest = test::OnDevice;

TEST_P(FluidSurfaceTest, BallHasTheVolumeOfItsParticlesAndTheAreaOfASphere) {
  for (const double ratio : {6.0, 10.0}) {
    const std::vector<Vec3f> particles = ball(float(ratio) * kSpacing, {0.1f, 0.2f, -0.3f});
    const double volume = double(particles.size()) * std::pow(double(kSpacing), 3);
    const double radius = std::cbrt(volume / volumeOfBall(1));
    for (const int passes : {0, 3}) {
      const TriangleMesh mesh =
          SurfaceScene(*device, particles, test::object({{"mesh_smoothing", passes}})).mesh();
      expectGood(mesh);
      EXPECT_EQ(test::eulerCharacteristic(mesh), 2);
      std::printf("radius %g spacings, %d passes: volume %.4f, area %.4f of what they should be\n", ratio,
                  passes, mesh.volume() / volume, mesh.area() / (4 * M_PI * radius * radius));
      EXPECT_NEAR(mesh.volume() / volume, 1, 0.05);
      EXPECT_NEAR(mesh.area() / (4 * M_PI * radius * radius), 1, 0.05);
    }
  }
}

TEST_P(FluidSurfaceTest, DropsApartArePiecesApart) {
  std::vector<Vec3f> particles = ball(4 * kSpacing, {0, 0, 0});
  for (const Vec3f& p : ball(3 * kSpacing, {0.3f, 0, 0})) particles.push_back(p);
  const TriangleMesh mesh = SurfaceScene(*device, particles).mesh();
  expectGood(mesh);
  EXPECT_EQ(test::components(mesh), 2);
  EXPECT_EQ(test::eulerCharacteristic(mesh), 4);
}

TEST_P(FluidSurfaceTest, ALoneParticleIsADropOfAboutItsVolume) {
  const TriangleMesh mesh =
      SurfaceScene(*device, {{0.013f, 0.001f, 0.007f}}, test::object({{"cell_size", 0.25}})).mesh();
  expectGood(mesh);
  EXPECT_EQ(test::eulerCharacteristic(mesh), 2);
  EXPECT_NEAR(mesh.volume() / std::pow(double(kSpacing), 3), 1, 0.06);
}

/// A thread along y, 7 spacings thick, as a nozzle cuts it out of particles in no order.
std::vector<Vec3f> roughThread() {
  std::vector<Vec3f> all;
  for (const Vec3f& p : test::jitteredCube(30, kSpacing, 0.4f, 5)) {
    const Vec3f seen = p - 15 * kSpacing * Vec3f{1, 1, 1};
    if (std::hypot(seen.x, seen.z) < 7 * kSpacing) all.push_back(seen);
  }
  return all;
}

/// Of the vertices in the middle of that thread: the radius in spacings, and how far normals are from the
/// thread's, as the root of the mean square of the sine.
struct Thread {
  double radius = 0, tilt = 0;
};
Thread threadOf(const DynamicMesh& mesh) {
  const std::vector<Vec3f> vertices = mesh.vertices.toHost(), normals = mesh.normals.toHost();
  Thread found;
  int count = 0;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const Vec3f& v = vertices[i];
    if (std::abs(v.y) > 7 * kSpacing) continue;
    const double radius = std::hypot(v.x, v.z);
    const double along = (double(normals[i].x) * v.x + double(normals[i].z) * v.z) / radius;
    found.radius += radius / kSpacing, found.tilt += 1 - along * along, ++count;
  }
  return {found.radius / count, std::sqrt(found.tilt / count)};
}

TEST_P(FluidSurfaceTest, PassesSmoothAThreadThatKeepsItsRadius) {
  Thread threads[3];
  const int passes[] = {0, 10, 80};
  for (int k = 0; k < 3; ++k) {
    SurfaceScene scene(*device, roughThread(), test::object({{"mesh_smoothing", passes[k]}}));
    expectGood(scene.mesh());
    threads[k] = threadOf(*scene.node().surface);
    std::printf("%d passes: radius %.3f spacings, tilt %.3f\n", passes[k], threads[k].radius,
                threads[k].tilt);
    EXPECT_NEAR(threads[k].radius, threads[0].radius, 0.05);
  }
  EXPECT_LT(threads[1].tilt, 0.8 * threads[0].tilt);
  EXPECT_LT(threads[2].tilt, 0.3 * threads[0].tilt);
}

TEST_P(FluidSurfaceTest, PassesKeepDrops) {
  for (const float radius : {0.1f, 1.5f, 3.0f}) {
    double volumes[2];
    for (int k = 0; k < 2; ++k) {
      const TriangleMesh mesh = SurfaceScene(*device, ball(radius * kSpacing, {0.013f, 0.001f, 0.007f}),
                                             test::object({{"mesh_smoothing", 100 * k}}))
                                    .mesh();
      expectGood(mesh);
      volumes[k] = mesh.volume();
    }
    const double share = volumes[1] / volumes[0];
    std::printf("radius %g: %.4f of the volume\n", radius, share);
    EXPECT_GT(share, radius < 1 ? 0.6 : 0.95);  // the smallest has 28 vertices
    EXPECT_LT(share, 1.01);
  }
}

TEST_P(FluidSurfaceTest, NoFluidNoSurface) {
  const TriangleMesh mesh = SurfaceScene(*device, {}).mesh();
  EXPECT_TRUE(mesh.vertices.empty());
  EXPECT_TRUE(mesh.triangles.empty());
}

TEST_P(FluidSurfaceTest, DisorderIsClosedToo) {
  // Thin and thick parts, holes and spray.
  std::vector<Vec3f> particles;
  for (const Vec3f& p : test::jitteredCube(14, 1.35f * kSpacing, 0.5f, 11)) particles.push_back(p);
  for (const int passes : {0, 2})
    expectGood(
        SurfaceScene(*device, particles, test::object({{"cell_size", 0.6}, {"mesh_smoothing", passes}}))
            .mesh());
}

/// A pool that has come to rest in no order, 0.1 m deep.
constexpr const char* kPool = R"({
  "weir": 1, "world": { "dt": 0.001, "frame_rate": 50, "duration": 0.1 },
  "nodes": {
    "block": { "type": "BoxSampler", "params": { "min": [0, 0, 0], "max": [0.16, 0.1, 0.16] } },
    "tank": { "type": "StaticBoundary",
              "params": { "shape": "box", "min": [0, 0, 0], "max": [0.16, 0.3, 0.16], "inverted": true } },
    "water": { "type": "ParticleFluid", "params": { "spacing": 0.01 },
               "modules": {"solver": {"type": "SemiImplicitSolver"}}},
    "surface": { "type": "FluidSurface" }
  },
  "links": ["block.particles -> water.initial", "tank.boundary -> water.boundaries",
            "water.fluid -> surface.fluid"]
})";

/// Of the vertices of the upper side, away from the walls, in spacings.
struct Roughness {
  double meanHeight = 0, rms = 0;
};
Roughness roughnessOf(const TriangleMesh& mesh) {
  std::vector<double> heights;
  for (const Vec3f& v : mesh.vertices)
    if (v.y > 0.07f && v.x > 0.03f && v.x < 0.13f && v.z > 0.03f && v.z < 0.13f)
      heights.push_back(double(v.y) / 0.01);
  Roughness found;
  for (const double h : heights) found.meanHeight += h / double(heights.size());
  for (const double h : heights) found.rms += std::pow(h - found.meanHeight, 2) / double(heights.size());
  found.rms = std::sqrt(found.rms);
  return found;
}

TEST_P(FluidSurfaceTest, AFlatPoolIsFlat) {
  test::SimulatedScene scene(*device, kPool);
  scene->reset();
  for (int frame = 0; frame < 3; ++frame) {
    const TriangleMesh mesh = test::onHost(*scene.node<FluidSurface>("surface").surface);
    expectGood(mesh);
    const Roughness found = roughnessOf(mesh);
    std::printf("height %.3f spacings, %.4f spacings rms\n", found.meanHeight, found.rms);
    EXPECT_NEAR(found.meanHeight, 10, 0.2);
    EXPECT_LT(found.rms, 0.05);
    EXPECT_NEAR(mesh.volume() / (0.16 * 0.16 * 0.1), 1, 0.05);
    const std::atomic<bool> stop = false;
    scene->advanceFrame(stop);
  }
}

TEST_P(FluidSurfaceTest, EverySettingHasALevelAndALoneDrop) {
  for (const float radius : {1.5f, 2.5f, 4.0f})
    for (const float smoothing : {0.0f, 1.0f})
      for (const float anisotropy : {1.0f, 10.0f}) {
        const KernelSettings settings{.spacing = kSpacing,
                                      .radius = radius * kSpacing,
                                      .smoothing = smoothing,
                                      .anisotropy = anisotropy};
        const float level = flatLevel(*device, settings);
        EXPECT_GT(level, 1e-3f) << radius << ' ' << smoothing << ' ' << anisotropy;
        EXPECT_LT(level, 1);
        EXPECT_GT(loneAxis(level, settings), 0.05f);
      }
}

TEST_P(FluidSurfaceTest, ChangesWithTheFluidAndIsTheSameAgain) {
  test::SimulatedScene scene(*device, kPool, {"water.rest_steps=0"});
  std::vector<Vec3f> before;
  for (int run = 0; run < 2; ++run) {
    scene->reset();
    const TriangleMesh first = test::onHost(*scene.node<FluidSurface>("surface").surface);
    const std::atomic<bool> stop = false;
    scene->advanceFrame(stop);
    const TriangleMesh next = test::onHost(*scene.node<FluidSurface>("surface").surface);
    EXPECT_FALSE(first.vertices == next.vertices);
    if (run == 1) {
      EXPECT_EQ(next.vertices, before);
    }
    before = next.vertices;
  }
}

WEIR_ON_EVERY_DEVICE(FluidSurfaceTest);

}  // namespace
}  // namespace weir
