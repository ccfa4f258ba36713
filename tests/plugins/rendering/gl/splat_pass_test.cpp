// Particles by a compute device: the pictures are those that OpenGL makes.
#include "plugins/rendering/gl/splatted_spheres.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/plugins/rendering/gl/pictures.h"

namespace weir::rendering {
namespace {

class Splats : public testing::TestWithParam<std::string> {
 protected:
  gl::Renderer reference{gl::makeContext()};
  gl::Renderer renderer{gl::makeContext(), openDevice(GetParam())};

  /// Pixels differ by no more than two grey levels, but for one in five thousand: rounding may move an
  /// outline over a sample's middle.
  void expectSamePicture(const View& view) {
    const Picture wanted = reference.draw(view), found = renderer.draw(view);
    ASSERT_EQ(wanted.rgb.size(), found.rgb.size());
    int different = 0;
    for (int y = 0; y < view.height; ++y)
      for (int x = 0; x < view.width; ++x)
        different += largestDifference(pixelAt(wanted, x, y), pixelAt(found, x, y)) > 2;
    EXPECT_LE(different, view.width * view.height / 5000);
  }
};

INSTANTIATE_TEST_SUITE_P(Devices, Splats, testing::ValuesIn(test::availableDevices()),
                         [](const auto& tested) { return tested.param; });

/// A block of particles and a few of another fluid above it, in front of plates and on a ground.
struct Scene {
  std::vector<Vec3f> block, drops;
  std::vector<float> values;
  View view;

  Scene() {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> part(0, 1);
    constexpr int kSide = 16;
    constexpr float kSpacing = 2.0f / kSide;
    for (int i = 0; i < kSide * kSide * kSide; ++i) {
      const Vec3f cell{float(i % kSide), float(i / kSide % kSide), float(i / kSide / kSide)};
      const Vec3f jitter{part(random), part(random), part(random)};
      block.push_back((cell + jitter * 0.6f) * kSpacing - Vec3f{1, 0, 1});
      values.push_back(part(random));
    }
    for (int i = 0; i < 12; ++i)
      drops.push_back({3 * part(random) - 1.5f, 2 + part(random), 3 * part(random) - 1.5f});
    view.width = 400;
    view.height = 300;
    view.camera = {.eye = {2.5f, 3, 5}, .target = {0, 0.9f, 0}, .fovDegrees = 45};
    view.particles = {{.positions = block, .values = values, .radius = 0.5f * kSpacing},
                      {.positions = drops, .radius = 0.15f, .fixed = {0.9f, 0.2f, 0.1f, 1}}};
    view.ground.radius = 12;
  }

  void addPlates(gl::Renderer& renderer) {
    const TriangleMesh plate =
        quad({-1.5f, 0.2f, 0.5f}, {1.5f, 0.2f, 0.5f}, {1.5f, 2, -0.5f}, {-1.5f, 2, -0.5f});
    for (const SurfaceLook look : {SurfaceLook::kMetal, SurfaceLook::kMatt})
      view.surfaces.push_back({.mesh = renderer.addMesh(plate),
                               .look = look,
                               .position = {look == SurfaceLook::kMatt ? 2.0f : 0, 0, 0}});
  }
};

TEST_P(Splats, GiveThePictureOfOpenGl) {
  Scene scene;
  expectSamePicture(scene.view);
  scene.view.lighting.unlit = true;
  scene.view.samplesPerAxis = 1;
  expectSamePicture(scene.view);
}

TEST_P(Splats, AreHiddenBySurfacesAndHideThem) {
  Scene scene, same;
  scene.addPlates(reference);
  same.addPlates(renderer);
  for (std::size_t i = 0; i < 2; ++i) ASSERT_EQ(scene.view.surfaces[i].mesh, same.view.surfaces[i].mesh);
  expectSamePicture(scene.view);
}

TEST_P(Splats, MayBeAllAroundTheCamera) {
  Scene scene;
  scene.view.camera = {.eye = {0.1f, 1, 0.1f}, .target = {1, 0.9f, 0.3f}, .fovDegrees = 100};
  scene.view.width = 240;
  scene.view.height = 180;
  expectSamePicture(scene.view);
  scene.view.camera.eye = scene.drops[0];  // within a sphere
  expectSamePicture(scene.view);
}

TEST_P(Splats, MayBeNone) {
  Scene scene;
  scene.view.particles.clear();
  expectSamePicture(scene.view);
}

TEST_P(Splats, AreTheSameEveryTime) {
  Scene scene;
  const Picture before = renderer.draw(scene.view);
  scene.view.width = 200;
  expectSamePicture(scene.view);
  scene.view.width = before.width;
  EXPECT_EQ(renderer.draw(scene.view).rgb, before.rgb);
}

}  // namespace
}  // namespace weir::rendering
