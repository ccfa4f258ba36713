// Liquids in pictures: what light does in them, in closed form where there is one, and the same picture
// whichever way their particles come into it.
#include <gtest/gtest.h>

#include <array>
#include <random>

#include "tests/plugins/rendering/gl/pictures.h"

namespace weir::rendering {
namespace {

double linearOf(int sRgb) {
  const double s = sRgb / 255.0;
  return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
}

TriangleMesh box(const Vec3f& lo, const Vec3f& hi) {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.vertices.push_back({i & 1 ? hi.x : lo.x, i & 2 ? hi.y : lo.y, i & 4 ? hi.z : lo.z});
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

/// A lattice with one particle per spacing cubed, which fills the box.
std::vector<Vec3f> lattice(const Vec3f& lo, const Vec3f& hi, float spacing) {
  std::vector<Vec3f> places;
  for (float z = lo.z + 0.5f * spacing; z < hi.z; z += spacing)
    for (float y = lo.y + 0.5f * spacing; y < hi.y; y += spacing)
      for (float x = lo.x + 0.5f * spacing; x < hi.x; x += spacing) places.push_back({x, y, z});
  return places;
}

ParticleView liquidOf(const std::vector<Vec3f>& positions, float spacing) {
  ParticleView particles{.positions = positions, .radius = 0.75f * spacing};
  particles.water = 0;
  particles.volume = spacing * spacing * spacing;
  return particles;
}

/// Without any scattering, so that Beer and Lambert have the say.
constexpr Vec3f kAbsorption{3, 1, 0.3f};
const WaterView kClear{.absorption = kAbsorption, .scattering = 0, .smoothing = 0.1f, .foamOpacity = 1000};

class Water : public testing::TestWithParam<std::string> {
 protected:
  static Pixel middle(const Picture& picture) {
    return pixelAt(picture, picture.width / 2, picture.height / 2);
  }
  /// White light after that many metres.
  static void expectLightThrough(double metres, double relative, const Pixel& pixel) {
    const std::array<int, 3> found{pixel.r, pixel.g, pixel.b};
    for (int c = 0; c < 3; ++c) {
      const double wanted = std::exp(-double(kAbsorption[c]) * metres);
      EXPECT_NEAR(linearOf(found[std::size_t(c)]), wanted, relative * wanted + 0.01) << c;
    }
  }

  gl::Renderer renderer{gl::makeContext(), splatDevice(GetParam())};
};

INSTANTIATE_TEST_SUITE_P(Drawers, Water, testing::ValuesIn(particleDrawers()),
                         [](const auto& tested) { return tested.param; });

TEST_P(Water, MeshAbsorbsLightByBeerAndLambert) {
  View view = plainView();
  view.waters = {kClear};
  view.surfaces = {
      {.mesh = renderer.addMesh(box({-1, -1, -0.3f}, {1, 1, 0.4f})), .look = SurfaceLook::kWater}};
  expectLightThrough(0.7, 0.01, middle(renderer.draw(view)));
  EXPECT_EQ(pixelAt(renderer.draw(view), 3, 3).sum(), 765);
}

TEST_P(Water, ParticlesAbsorbLightByTheirVolume) {
  constexpr float kSpacing = 0.05f;
  const std::vector<Vec3f> block = lattice({-0.8f, -0.8f, -0.3f}, {0.8f, 0.8f, 0.4f}, kSpacing);
  View view = plainView();
  view.waters = {kClear};
  view.particles = {liquidOf(block, kSpacing)};
  expectLightThrough(0.7, 0.04, middle(renderer.draw(view)));
}

TEST_P(Water, EndsWhereSomethingOpaqueStands) {
  constexpr float kSpacing = 0.05f;
  const std::vector<Vec3f> block = lattice({-0.8f, -0.8f, -0.8f}, {0.8f, 0.8f, 0.4f}, kSpacing);
  View view = plainView();
  view.waters = {kClear};
  view.particles = {liquidOf(block, kSpacing)};
  const MeshId plate = renderer.addMesh(quad({-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}));
  view.surfaces = {{.mesh = plate, .color = {1, 1, 1, 1}}};
  expectLightThrough(0.4, 0.06, middle(renderer.draw(view)));
  view.surfaces[0].position = {0, 0, 1};  // before it
  EXPECT_EQ(middle(renderer.draw(view)).sum(), 765);
}

TEST_P(Water, WhiteDropsInItDarkenNothing) {
  // Most cover one or two of a pixel's four samples; behind the others, nothing reflects any light.
  constexpr float kSpacing = 0.05f;
  const std::vector<Vec3f> block = lattice({-0.8f, -0.8f, -0.8f}, {0.8f, 0.8f, 0.4f}, kSpacing);
  View view = plainView();
  view.backgroundTop = view.backgroundBottom = {0, 0, 0, 1};
  view.lighting = {.shadows = false, .occlusion = false};
  view.waters = {{.absorption = {4, 1, 0.5f}, .scattering = 2, .smoothing = 0.1f}};
  view.particles = {liquidOf(block, kSpacing)};
  const Picture before = renderer.draw(view);
  std::mt19937 random(5);
  std::uniform_real_distribution<float> along(-0.7f, 0.7f), under(0.25f, 0.38f);
  std::vector<Vec3f> drops;
  for (int i = 0; i < 200; ++i) drops.push_back({along(random), along(random), under(random)});
  view.particles.push_back({.positions = drops, .radius = 0.015f, .fixed = {1, 1, 1, 1}, .white = true});
  const Picture after = renderer.draw(view);
  int darker = 0, brighter = 0;
  for (std::size_t i = 0; i < after.rgb.size(); ++i) {
    darker += after.rgb[i] + 5 < before.rgb[i];
    brighter += after.rgb[i] > before.rgb[i] + 20;
  }
  EXPECT_EQ(darker, 0);
  EXPECT_GT(brighter, 200);
}

TEST_P(Water, OutlinesAreThoseOfTheSpheres) {
  // A ball of radius 1 around the origin, made of one sphere; smoothing does not widen it.
  const std::vector<Vec3f> one{{0, 0, 0}};
  View view = plainView(240, 240);
  view.waters = {kClear};
  view.waters[0].absorption = {20, 20, 20};
  view.waters[0].smoothing = 0.5f;
  view.particles = {liquidOf(one, 1)};
  view.particles[0].radius = 1;
  const Picture picture = renderer.draw(view);
  // The cone that touches it: tan = r / sqrt(d² - r²); 30 degrees are half the picture.
  const double pixels = 120 * (1 / std::sqrt(24.0)) / std::tan(std::numbers::pi / 6);
  for (int x = 0; x < 240; ++x) {
    const double away = std::abs(x + 0.5 - 120);
    if (away > pixels + 1) {
      EXPECT_EQ(pixelAt(picture, x, 120).sum(), 765) << x;
    }
    if (away < pixels - 6) {
      EXPECT_LT(pixelAt(picture, x, 120).sum(), 700) << x;
    }
  }
}

TEST_P(Water, FlatPoolsLookFlat) {
  constexpr float kSpacing = 0.04f;
  std::vector<Vec3f> pool = lattice({-1, -0.3f, -1}, {1, 0, 1}, kSpacing);
  std::mt19937 random(3);
  std::uniform_real_distribution<float> jitter(-0.1f, 0.1f);
  for (Vec3f& p : pool) p += Vec3f{jitter(random), jitter(random), jitter(random)} * kSpacing;
  View view;
  view.width = 240;
  view.height = 180;
  view.camera = {.eye = {0, 1.4f, 2.2f}, .target = {0, -0.1f, 0.1f}, .fovDegrees = 35};
  view.ground.height = -0.3f;
  view.waters = {{.smoothing = 2 * kSpacing}};
  view.particles = {liquidOf(pool, kSpacing)};
  const auto steps = [&](const Picture& picture) {
    int largest = 0;
    for (int y = 70; y < 110; ++y)
      for (int x = 80; x < 160; ++x)
        largest = std::max(largest, largestDifference(pixelAt(picture, x, y), pixelAt(picture, x + 1, y)));
    return largest;
  };
  const int smooth = steps(renderer.draw(view));
  EXPECT_LE(smooth, 4);
  view.waters[0].smoothing = 1e-4f;  // so that the spheres are seen
  EXPECT_GT(steps(renderer.draw(view)), 3 * smooth);
}

TEST_P(Water, FoamIsWhite) {
  constexpr float kSpacing = 0.05f;
  const std::vector<Vec3f> block = lattice({-0.5f, -0.5f, -0.5f}, {0.5f, 0.5f, 0.5f}, kSpacing);
  View view = plainView();
  view.waters = {kClear};
  view.particles = {liquidOf(block, kSpacing)};
  std::vector<float> foam(block.size(), 0.0f);
  view.particles[0].foam = foam;
  EXPECT_LT(middle(renderer.draw(view)).r, 100);
  // Far below the surface it is not seen, at the surface it is.
  for (std::size_t i = 0; i < block.size(); ++i) foam[i] = block[i].z < -0.3f;
  EXPECT_LT(middle(renderer.draw(view)).r, 100);
  for (std::size_t i = 0; i < block.size(); ++i) foam[i] = block[i].z > 0.3f;
  EXPECT_GT(middle(renderer.draw(view)).r, 250);
}

TEST_P(Water, ShadowsHaveItsColor) {
  constexpr float kSpacing = 0.05f;
  const std::vector<Vec3f> block = lattice({-0.5f, 0.8f, -0.5f}, {0.5f, 1.2f, 0.5f}, kSpacing);
  View view;
  view.width = 240;
  view.height = 180;
  view.camera = {.eye = {0, 3, 6}, .target = {0, 0.4f, 0}, .fovDegrees = 40};
  view.lighting.towardsSun = {-1, 1, 0};
  view.lighting.occlusion = false;
  view.ground.radius = 30;
  view.waters = {kClear};
  view.particles = {liquidOf(block, kSpacing)};
  const auto [x, y] = pixelOf(view, {1, 0, 0}).value();
  const Pixel shadow = pixelAt(renderer.draw(view), x, y);
  view.lighting.shadows = false;
  const Pixel open = pixelAt(renderer.draw(view), x, y);
  EXPECT_LT(shadow.b, open.b - 8);
  EXPECT_LT(shadow.r, shadow.b - 8);
}

TEST_P(Water, ShadowsOnItAreSmooth) {
  // The edge of a plate's shadow on milky water, which is blurred over many pixels.
  View view;
  view.width = 240;
  view.height = 180;
  view.camera = {.eye = {0, 2, 0.01f}, .target = {0, 0, 0}, .fovDegrees = 8};
  view.lighting.towardsSun = {0, 1, 0};
  view.ground.visible = false;
  view.waters = {{.absorption = {0, 0, 0}, .scattering = 50, .smoothing = 0.1f}};
  const MeshId pool = renderer.addMesh(box({-4, -1, -4}, {4, 0, 4}));
  const MeshId plate = renderer.addMesh(quad({0, 3, -4}, {0, 3, 4}, {4, 3, 4}, {4, 3, -4}));
  view.surfaces = {{.mesh = pool, .look = SurfaceLook::kWater}, {.mesh = plate}};
  const Picture picture = renderer.draw(view);
  int rough = 0, darkest = 765, brightest = 0;
  for (int y = 20; y < 160; ++y)
    for (int x = 20; x < 220; ++x) {
      const auto at = [&](int across, int up) { return pixelAt(picture, x + across, y + up).sum(); };
      rough = std::max(rough, std::abs(at(0, 0) - at(1, 0) - at(0, 1) + at(1, 1)));
      darkest = std::min(darkest, at(0, 0)), brightest = std::max(brightest, at(0, 0));
    }
  EXPECT_GT(brightest, darkest + 60) << "there is no shadow";
  EXPECT_LT(rough, 12);
}

TEST_P(Water, GlassBehindIsSeenThroughItAndGlassBeforeOverIt) {
  constexpr float kSpacing = 0.05f;
  const std::vector<Vec3f> block = lattice({-0.5f, -0.5f, -0.2f}, {0.5f, 0.5f, 0.2f}, kSpacing);
  View view = plainView();
  view.waters = {kClear};
  view.particles = {liquidOf(block, kSpacing)};
  const Pixel bare = middle(renderer.draw(view));
  const MeshId plate = renderer.addMesh(quad({-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}));
  for (const float z : {-1.0f, 1.0f}) {
    view.surfaces = {
        {.mesh = plate, .look = SurfaceLook::kGlass, .color = {1, 0.02f, 1, 1}, .position = {0, 0, z}}};
    const Pixel tinted = middle(renderer.draw(view));
    EXPECT_LT(tinted.g, 0.92 * bare.g) << z;
    EXPECT_NEAR(tinted.r, bare.r, 8) << z;
  }
}

TEST_P(Water, NearerLiquidsComeOverFartherOnes) {
  View view = plainView();
  view.waters = {kClear, kClear};
  view.waters[1].absorption = {0.3f, 1, 3};
  const MeshId slab = renderer.addMesh(box({-1, -1, -0.2f}, {1, 1, 0.2f}));
  view.surfaces = {{.mesh = slab, .look = SurfaceLook::kWater, .position = {0, 0, 1}, .water = 0},
                   {.mesh = slab, .look = SurfaceLook::kWater, .position = {0, 0, -1}, .water = 1}};
  const Pixel both = middle(renderer.draw(view));
  for (const int c : {both.r, both.b}) EXPECT_NEAR(linearOf(c), std::exp(-0.4 * 3.3), 0.02);
  EXPECT_NEAR(linearOf(both.g), std::exp(-0.4 * 2.0), 0.02);
}

TEST_P(Water, PicturesAreThoseOfOpenGl) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> part(0, 1);
  std::vector<Vec3f> positions = lattice({-1, 0, -0.5f}, {0.4f, 0.6f, 0.5f}, 0.06f);
  for (int i = 0; i < 200; ++i)
    positions.push_back({2 * part(random) - 1, 0.6f + part(random), part(random) - 0.5f});
  positions.push_back({std::nanf(""), 0, 0});
  std::vector<float> foam;
  for (const Vec3f& p : positions) foam.push_back(p.y > 0.5f ? part(random) : 0.0f);
  View view;
  view.width = 320;
  view.height = 240;
  view.camera = {.eye = {1.6f, 1.3f, 2.4f}, .target = {0, 0.4f, 0}, .fovDegrees = 40};
  view.ground.tiles = 0.25f;
  view.environment = EnvironmentLook::kSky;
  view.lighting.tone = ToneCurve::kFilmic;
  view.waters = {{.smoothing = 0.12f}};
  view.particles = {liquidOf(positions, 0.06f)};
  view.particles[0].foam = foam;
  gl::Renderer reference{gl::makeContext()};
  const MeshId post = reference.addMesh(box({0.3f, 0, 0.1f}, {0.5f, 1, 0.3f}));
  ASSERT_EQ(renderer.addMesh(box({0.3f, 0, 0.1f}, {0.5f, 1, 0.3f})), post);
  view.surfaces = {{.mesh = post}};
  const Picture wanted = reference.draw(view), found = renderer.draw(view);
  int different = 0;
  for (int y = 0; y < view.height; ++y)
    for (int x = 0; x < view.width; ++x)
      different += largestDifference(pixelAt(wanted, x, y), pixelAt(found, x, y)) > 2;
  EXPECT_LE(different, view.width * view.height / 2000);
}

}  // namespace
}  // namespace weir::rendering
