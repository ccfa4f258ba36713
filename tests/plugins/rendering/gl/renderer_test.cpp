#include "plugins/rendering/gl/renderer.h"

#include <gtest/gtest.h>

#include <array>

#include "framework/base/check.h"
#include "framework/base/error.h"
#include "tests/plugins/rendering/gl/pictures.h"

namespace weir::rendering {
namespace {

constexpr Color kRed{1, 0, 0, 1};

class RendererTest : public testing::Test {
 protected:
  MeshId addPlate(float z) { return renderer.addMesh(quad({-1, -1, z}, {1, -1, z}, {1, 1, z}, {-1, 1, z})); }
  static Pixel middle(const Picture& picture) {
    return pixelAt(picture, picture.width / 2, picture.height / 2);
  }

  gl::Renderer renderer{gl::makeContext()};
};

TEST_F(RendererTest, BackgroundGoesFromTopToBottom) {
  View view = plainView();
  view.backgroundTop = {0.2f, 0.4f, 0.6f, 1};
  view.backgroundBottom = {0.9f, 0.8f, 0.7f, 1};
  const Picture picture = renderer.draw(view);
  ASSERT_EQ(picture.rgb.size(), 3u * 160 * 120);
  EXPECT_LE(largestDifference(pixelAt(picture, 80, 0), {51, 102, 153}), 2);
  EXPECT_LE(largestDifference(pixelAt(picture, 80, 119), {230, 204, 179}), 2);
}

/// A sphere above the ground, the sun high on its left: its shadow falls on its right.
struct ShadowScene {
  std::array<Vec3f, 1> positions{Vec3f{0, 1, 0}};
  View view;
  ShadowScene() {
    view.width = 320;
    view.height = 240;
    view.camera = {.eye = {0, 4, 5}, .target = {0, 0.4f, 0}, .fovDegrees = 50};
    view.particles = {{.positions = positions, .radius = 0.4f}};
    view.ground.radius = 30;
    view.lighting.towardsSun = {-1, 1.25f, 0};
  }
};

TEST_F(RendererTest, ShadowFallsWhereTheSunSaysSo) {
  ShadowScene scene;
  const Picture picture = renderer.draw(scene.view);
  scene.view.lighting.shadows = false;
  const Picture open = renderer.draw(scene.view);
  // The sphere's middle is 1 m high, so its shadow's middle is 1/1.25 m to the right.
  const auto [x, y] = pixelOf(scene.view, {0.8, 0, 0}).value();
  EXPECT_LT(pixelAt(picture, x, y).sum(), 0.85 * pixelAt(open, x, y).sum());
  // The mirrored place, and one beyond the shadow's end: 0.8 + 0.4·√(1 + 0.8²) = 1.31.
  for (const double lit : {-0.8, 1.45}) {
    const auto [lx, ly] = pixelOf(scene.view, {lit, 0, 0}).value();
    EXPECT_LE(largestDifference(pixelAt(picture, lx, ly), pixelAt(open, lx, ly)), 2) << lit;
  }
}

TEST_F(RendererTest, ShadowFallsOnParticles) {
  // A plate between the sun and the particle.
  const std::array<Vec3f, 1> positions{Vec3f{0, 0, 0}};
  View view = plainView();
  view.lighting.unlit = false;
  view.lighting.towardsSun = {0, 1, 0.2f};
  view.particles = {{.positions = positions, .radius = 0.5f}};
  const MeshId roof = renderer.addMesh(quad({-1, 1.5f, -1}, {-1, 1.5f, 1}, {1, 1.5f, 1}, {1, 1.5f, -1}));
  const auto [x, y] = pixelOf(view, {0, 0.35, 0.35}).value();
  const int lit = pixelAt(renderer.draw(view), x, y).sum();
  view.surfaces = {{.mesh = roof}};
  EXPECT_LT(pixelAt(renderer.draw(view), x, y).sum(), 0.85 * lit);
}

TEST_F(RendererTest, WallsThatTheSunGrazesDoNotShadeThemselves) {
  // 16 degrees, and texels of 0.15 m.
  View view = plainView();
  view.lighting.unlit = view.lighting.occlusion = false;
  view.lighting.towardsSun = {0.6f, 0.6f, 0.25f};
  const MeshId wall = renderer.addMesh(quad({-60, -60, 0}, {60, -60, 0}, {60, 60, 0}, {-60, 60, 0}));
  view.surfaces = {{.mesh = wall}};
  const Picture shaded = renderer.draw(view);
  view.lighting.shadows = false;
  EXPECT_LE(largestDifference(shaded, renderer.draw(view)), 1);
}

TEST_F(RendererTest, CornersAreDarkerThanOpenGround) {
  ShadowScene scene;
  scene.positions[0] = {0, 0.4f, 0};
  scene.view.lighting.shadows = false;
  scene.view.lighting.occlusionRadius = 0.5f;
  const auto [x, y] = pixelOf(scene.view, {0, 0, 0.3}).value();
  const int withOcclusion = pixelAt(renderer.draw(scene.view), x, y).sum();
  scene.view.lighting.occlusion = false;
  EXPECT_LT(withOcclusion, 0.95 * pixelAt(renderer.draw(scene.view), x, y).sum());
}

TEST_F(RendererTest, GroundIsSeenFromAboveOnly) {
  View view = plainView();
  view.ground = {.visible = true, .height = 0, .radius = 20, .color = kRed};
  view.camera.eye = {0, 3, 5};
  EXPECT_LT(middle(renderer.draw(view)).g, 30);
  view.camera.eye = {0, -3, 5};
  EXPECT_GT(middle(renderer.draw(view)).g, 250);
}

TEST_F(RendererTest, GroundFadesIntoTheBackground) {
  View view = plainView();
  view.ground = {.visible = true, .height = 0, .radius = 20, .color = kRed};
  view.camera = {.eye = {0, 3, 5}, .target = {0, 0, -10}, .fovDegrees = 60};
  const Picture picture = renderer.draw(view);
  int before = 0;
  for (const double z : {1.0, -6.0, -10.0, -14.0, -18.5}) {
    const auto [x, y] = pixelOf(view, {0, 0, z}).value();
    const int green = pixelAt(picture, x, y).g;
    EXPECT_GE(green, before) << z;
    before = green;
  }
  EXPECT_GT(before, 245);
}

TEST_F(RendererTest, GlassLetsThroughWhatIsBehindAndTintsIt) {
  const std::array<Vec3f, 1> positions{Vec3f{0, 0, 0}};
  View view = plainView();
  view.particles = {{.positions = positions, .radius = 0.8f, .fixed = {0.8f, 0.8f, 0.8f, 1}}};
  const Pixel bare = middle(renderer.draw(view));
  const MeshId plate = addPlate(1);
  view.surfaces = {{.mesh = plate, .look = SurfaceLook::kGlass, .color = {1, 1, 1, 1}}};
  EXPECT_LE(largestDifference(middle(renderer.draw(view)), bare), 16);
  view.surfaces[0].color = {1, 0.05f, 0.05f, 1};
  const Pixel tinted = middle(renderer.draw(view));
  EXPECT_GT(tinted.r, tinted.g + 30);
  EXPECT_NEAR(tinted.r, bare.r, 16);
  view.surfaces[0] = {.mesh = plate, .look = SurfaceLook::kMatt, .color = kRed};
  EXPECT_LT(middle(renderer.draw(view)).g, 5);
}

TEST_F(RendererTest, GlassBehindIsHidden) {
  const std::array<Vec3f, 1> positions{Vec3f{0, 0, 0}};
  View view = plainView();
  view.lighting.unlit = false;
  view.lighting.shadows = view.lighting.occlusion = false;
  view.particles = {{.positions = positions, .radius = 0.8f, .fixed = kRed}};
  const Pixel bare = middle(renderer.draw(view));
  view.surfaces = {{.mesh = addPlate(-1), .look = SurfaceLook::kGlass, .color = {0, 0, 1, 1}}};
  EXPECT_LE(largestDifference(middle(renderer.draw(view)), bare), 1);
}

TEST_F(RendererTest, SurfacesAreTurnedAndMoved) {
  View view = plainView();
  const float half = std::sqrt(0.5f);
  const MeshId plate = addPlate(0);
  // Turned by 90 degrees about y it is seen from its edge; moved aside it leaves the middle.
  view.surfaces = {{.mesh = plate, .color = kRed, .rotation = {half, 0, half, 0}}};
  EXPECT_GT(pixelAt(renderer.draw(view), 90, 60).g, 250);
  view.surfaces = {{.mesh = plate, .color = kRed, .position = {0, 0, 1}}};
  EXPECT_LT(pixelAt(renderer.draw(view), 90, 60).g, 5);
  view.surfaces = {{.mesh = plate, .color = kRed, .position = {2.2f, 0, 0}}};
  EXPECT_GT(middle(renderer.draw(view)).g, 250);
}

TEST_F(RendererTest, ReplacedMeshesChangeAndUnknownOnesAreRefused) {
  View view = plainView();
  const MeshId plate = addPlate(0);
  view.surfaces = {{.mesh = plate, .color = kRed}};
  EXPECT_LT(middle(renderer.draw(view)).g, 5);
  const TriangleMesh aside = quad({2, 2, 0}, {3, 2, 0}, {3, 3, 0}, {2, 3, 0});
  const std::vector<Vec3f> normals(4, Vec3f{0, 0, 1});
  const ShownMesh shown(MeshSpan{aside.vertices, normals, aside.triangles});
  renderer.replaceMesh(plate, shown);
  EXPECT_GT(middle(renderer.draw(view)).g, 250);
  view.surfaces[0].mesh = plate + 1;
  EXPECT_THROW(renderer.draw(view), InternalError);
  EXPECT_THROW(renderer.replaceMesh(plate + 1, shown), InternalError);
}

TEST_F(RendererTest, LinesAreSeenAndHidden) {
  const std::array<Vec3f, 2> points{Vec3f{-2, 0, 0}, Vec3f{2, 0, 0}};
  View view = plainView(160, 121);  // a row of pixels in the middle
  view.lines = {{.points = points, .color = {0, 0, 0, 1}, .width = 12}};
  const Picture seen = renderer.draw(view);
  EXPECT_LT(middle(seen).sum(), 5);
  EXPECT_EQ(pixelAt(seen, 80, 64).sum(), 765);
  view.surfaces = {{.mesh = addPlate(0.5f), .color = kRed}};
  EXPECT_EQ(middle(renderer.draw(view)).r, 255);
}

TEST_F(RendererTest, LinesThroughTheCameraAreCut) {
  // From far ahead to behind the camera, one unit below the eye: it ends at the picture's lower edge.
  const std::array<Vec3f, 2> points{Vec3f{0, -1, -50}, Vec3f{0, -1, 50}};
  View view = plainView();
  view.lines = {{.points = points, .color = {0, 0, 0, 1}, .width = 12}};
  const Picture picture = renderer.draw(view);
  EXPECT_LT(pixelAt(picture, 80, 119).sum(), 5);
  EXPECT_LT(pixelAt(picture, 80, 90).sum(), 5);
  EXPECT_EQ(pixelAt(picture, 80, 10).sum(), 765);
}

TEST_F(RendererTest, ChangesItsSize) {
  ShadowScene scene;
  const Picture before = renderer.draw(scene.view);
  scene.view.width = 101;
  scene.view.height = 333;
  scene.view.samplesPerAxis = 3;
  const Picture other = renderer.draw(scene.view);
  EXPECT_EQ(other.width, 101);
  EXPECT_EQ(other.rgb.size(), 3u * 101 * 333);
  scene.view.width = 320;
  scene.view.height = 240;
  scene.view.samplesPerAxis = 2;
  EXPECT_EQ(renderer.draw(scene.view).rgb, before.rgb);
}

TEST_F(RendererTest, EmptySceneIsTheBackground) {
  View view = plainView();
  view.lighting.unlit = false;
  for (const int y : {0, 60, 119}) EXPECT_GT(pixelAt(renderer.draw(view), 80, y).g, 235);
}

TEST_F(RendererTest, ImpossiblePicturesAreErrors) {
  View view = plainView();
  view.width = 1 << 20;
  EXPECT_THROW(renderer.draw(view), Error);
  view.width = 160;
  view.camera.eye = view.camera.target;
  EXPECT_THROW(renderer.draw(view), Error);
  view.camera = {.fovDegrees = 180};
  EXPECT_THROW(renderer.draw(view), Error);
}

}  // namespace
}  // namespace weir::rendering
