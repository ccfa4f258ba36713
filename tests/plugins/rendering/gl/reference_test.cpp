// Pictures beside those in the folder reference/, so that a change of the looks is noticed. If one is wanted,
// WEIR_NEW_REFERENCES=1 in the environment makes this program write the folder's pictures anew; look at them
// before they are committed.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "tests/plugins/rendering/gl/like_pictures.h"
#include "tests/plugins/rendering/gl/pictures.h"
#include "tests/plugins/video/read_png.h"

namespace weir::rendering {
namespace {

/// Particles of a basin with waves, and drops above it.
struct Waves {
  static constexpr float kSpacing = 0.04f;
  std::vector<Vec3f> positions;
  std::vector<float> height;

  Waves() {
    for (float x = -1; x < 1; x += kSpacing)
      for (float z = -0.6f; z < 0.6f; z += kSpacing)
        for (float y = 0.5f * kSpacing; y < 0.3f + 0.08f * std::sin(5 * x + 2 * z); y += kSpacing)
          positions.push_back({x, y, z});
    for (int i = 0; i < 24; ++i) {
      const auto k = static_cast<float>(i);
      positions.push_back({0.9f * std::sin(2.4f * k), 0.5f + 0.02f * k, 0.5f * std::cos(1.7f * k)});
    }
    for (const Vec3f& p : positions) height.push_back(p.y);
  }
};

TriangleMesh ball(int rings, float radius) {
  TriangleMesh mesh;
  for (int i = 0; i <= rings; ++i)
    for (int j = 0; j < 2 * rings; ++j) {
      const double polar = std::numbers::pi * i / rings, around = std::numbers::pi * j / rings;
      const Vec3f place{float(std::sin(polar) * std::cos(around)), float(std::cos(polar)),
                        float(std::sin(polar) * std::sin(around))};
      mesh.vertices.push_back(radius * place);
    }
  for (int i = 0; i < rings; ++i)
    for (int j = 0; j < 2 * rings; ++j) {
      const int next = (j + 1) % (2 * rings), a = 2 * rings * i, b = a + 2 * rings;
      mesh.triangles.push_back({a + j, a + next, b + j});
      mesh.triangles.push_back({a + next, b + next, b + j});
    }
  return mesh;
}

View smallView() {
  View view;
  view.width = 256;
  view.height = 160;
  view.camera = {.eye = {1.7f, 1.25f, 2.3f}, .target = {0, 0.25f, 0}, .fovDegrees = 36};
  return view;
}

class Reference : public testing::Test {
 protected:
  /// Two grey levels, but for one pixel in a thousand: rounding may move an outline over a sample's middle.
  void expectReference(const std::string& name, const View& view) {
    const std::filesystem::path path = std::filesystem::path(WEIR_REFERENCE_PICTURES) / (name + ".png");
    const Picture found = renderer.draw(view);
    SCOPED_TRACE(path);
    if (std::getenv("WEIR_NEW_REFERENCES") != nullptr) writePng(path, found);
    const Picture wanted = test::readPng(path.string());
    expectLike(wanted, found, view.width * view.height / 1000);
  }

  gl::Renderer renderer{gl::makeContext(), openDevice("cpu")};
};

TEST_F(Reference, Spheres) {
  const Waves waves;
  View view = smallView();
  view.particles = {{.positions = waves.positions, .values = waves.height, .radius = 0.5f * Waves::kSpacing}};
  expectReference("spheres", view);
}

TEST_F(Reference, WaterUnderTheSky) {
  const Waves waves;
  std::vector<float> foam;
  for (const Vec3f& p : waves.positions) foam.push_back(p.y > 0.35f ? 0.6f : 0.0f);
  View view = smallView();
  view.environment = EnvironmentLook::kSky;
  view.lighting.tone = ToneCurve::kFilmic;
  view.ground.tiles = 0.25f;
  view.ground.color = {0.5f, 0.49f, 0.47f, 1};
  view.waters = {{.smoothing = 2 * Waves::kSpacing}};
  view.particles = {{.positions = waves.positions, .radius = 0.75f * Waves::kSpacing, .water = 0}};
  view.particles[0].foam = foam;
  view.particles[0].volume = Waves::kSpacing * Waves::kSpacing * Waves::kSpacing;
  expectReference("water_sky", view);
}

TEST_F(Reference, Looks) {
  View view = smallView();
  view.camera.eye = {0, 1.1f, 3.4f};
  view.ground.tiles = 0.3f;
  view.ground.color = {0.45f, 0.45f, 0.48f, 1};
  view.waters = {{.smoothing = 0}};
  const MeshId small = renderer.addMesh(ball(24, 0.36f));
  float x = -1.2f;
  for (const SurfaceLook look :
       {SurfaceLook::kMatt, SurfaceLook::kMetal, SurfaceLook::kGlass, SurfaceLook::kWater}) {
    view.surfaces.push_back(
        {.mesh = small, .look = look, .color = {0.85f, 0.7f, 0.5f, 1}, .position = {x, 0.36f, 0}});
    x += 0.8f;
  }
  expectReference("looks_studio", view);
  view.environment = EnvironmentLook::kSky;
  expectReference("looks_sky", view);
}

}  // namespace
}  // namespace weir::rendering
