#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <limits>
#include <random>

#include "tests/plugins/rendering/gl/pictures.h"

namespace weir::rendering {
namespace {

constexpr Color kRed{1, 0, 0, 1};

/// How many pixels of a picture of one red sphere on white are wrong: red where the ray through the pixel's
/// middle misses the sphere, or white where it hits. Rays that all but touch it are not counted.
int wrongPixels(const View& view, const Vec3f& center, const Picture& picture, int* red = nullptr) {
  const double tangent = std::tan(view.camera.fovDegrees * std::numbers::pi / 360);
  const double r = view.particles[0].radius;
  const Vec3d c{center.x - view.camera.eye.x, center.y - view.camera.eye.y, center.z - view.camera.eye.z};
  int wrong = 0;
  for (int y = 0; y < view.height; ++y) {
    for (int x = 0; x < view.width; ++x) {
      const Vec3d ray =
          normalized(Vec3d{(2 * (x + 0.5) / view.width - 1) * tangent * view.width / view.height,
                           (1 - 2 * (y + 0.5) / view.height) * tangent, -1});
      const double missedBy = length(c - ray * dot(ray, c)) - r;
      const bool isRed = pixelAt(picture, x, y).g < 128;
      if (red) *red += isRed;
      if (std::abs(missedBy) > 1e-5 * r && isRed != (missedBy < 0)) ++wrong;
    }
  }
  return wrong;
}

class Particles : public testing::TestWithParam<std::string> {
 protected:
  gl::Renderer renderer{gl::makeContext(), splatDevice(GetParam())};
};

INSTANTIATE_TEST_SUITE_P(Drawers, Particles, testing::ValuesIn(particleDrawers()),
                         [](const auto& tested) { return tested.param; });

TEST_P(Particles, SilhouetteIsTheExactEllipse) {
  // In the middle, near a corner where it is far from round, cut by the frame with its middle outside, small
  // and far away, and so near that it fills the picture's height.
  const std::array<std::pair<Vec3f, float>, 5> cases{{{{0, 0, 0}, 1.0f},
                                                      {{4.5f, 3.2f, 0.0f}, 0.8f},
                                                      {{-6.4f, 0.3f, 0.0f}, 0.9f},
                                                      {{40, -30, -95}, 2.0f},
                                                      {{0.5f, 0.2f, 3.0f}, 1.7f}}};
  for (const auto& [center, radius] : cases) {
    View view = plainView(320, 240);
    view.camera.target = {0, 0, -100};
    view.camera.fovDegrees = 90;
    view.samplesPerAxis = 1;
    const std::array<Vec3f, 1> positions{center};
    view.particles = {{.positions = positions, .radius = radius, .fixed = kRed}};
    int red = 0;
    EXPECT_EQ(wrongPixels(view, center, renderer.draw(view), &red), 0) << center.x;
    EXPECT_GT(red, 2) << center.x;
  }
}

TEST_P(Particles, EdgesAreSmooth) {
  const std::array<Vec3f, 1> positions{Vec3f{0, 0, 0}};
  View view = plainView();
  view.particles = {{.positions = positions, .radius = 1, .fixed = kRed}};
  const Picture picture = renderer.draw(view);
  int between = 0;
  for (int x = 0; x < view.width; ++x)
    for (int y = 0; y < view.height; ++y) {
      const int green = pixelAt(picture, x, y).g;
      between += green > 10 && green < 245;
    }
  EXPECT_GT(between, 30);
}

TEST_P(Particles, HaveTheColorsOfTheirValues) {
  // A row of spheres, so that the pixel in each one's middle shows one value.
  const std::array<float, 6> values{-3, 2, 3.1f, 4.7f, 6, std::numeric_limits<float>::quiet_NaN()};
  std::array<Vec3f, 6> positions;
  for (int i = 0; i < 6; ++i) positions[i] = {-2.5f + float(i), 0.02f, 0};
  for (const ColorMapName map :
       {ColorMapName::kViridis, ColorMapName::kTurbo, ColorMapName::kCividis, ColorMapName::kCoolwarm}) {
    View view = plainView(320, 240);
    view.particles = {
        {.positions = positions, .values = values, .radius = 0.3f, .map = map, .lowest = 2, .highest = 6}};
    const Picture picture = renderer.draw(view);
    for (int i = 0; i < 6; ++i) {
      const auto [x, y] = pixelOf(view, {positions[i].x, positions[i].y, 0}).value();
      const Pixel expected = toPixel(ColorMap(map).at((values[i] - 2) / 4));
      EXPECT_LE(largestDifference(pixelAt(picture, x, y), expected), 2) << i;
    }
  }
}

TEST_P(Particles, NearerOnesHideFartherOnesInAnyOrder) {
  const std::array<float, 2> values{0, 1};
  for (const bool swapped : {false, true}) {
    std::array<Vec3f, 2> positions{Vec3f{0, 0, 1}, Vec3f{0, 0, -1}};
    if (swapped) std::swap(positions[0], positions[1]);
    View view = plainView();
    view.particles = {{.positions = positions, .values = values, .radius = 0.5f}};
    const Pixel seen = pixelAt(renderer.draw(view), view.width / 2, view.height / 2);
    EXPECT_LE(largestDifference(seen, toPixel(ColorMap(ColorMapName::kViridis).at(swapped ? 1 : 0))), 2);
  }
}

TEST_P(Particles, MeetWhereTheirSurfacesMeet) {
  // Two spheres through each other: left of their common plane the left one is in front, right of it the
  // other.
  const std::array<float, 2> values{0, 1};
  const std::array<Vec3f, 2> positions{Vec3f{-0.3f, 0, 0}, Vec3f{0.3f, 0, 0}};
  View view = plainView();
  view.particles = {{.positions = positions, .values = values, .radius = 0.5f}};
  const Picture picture = renderer.draw(view);
  for (const int step : {-8, -3, 3, 8}) {
    const Pixel seen = pixelAt(picture, view.width / 2 + step, view.height / 2);
    EXPECT_LE(largestDifference(seen, toPixel(ColorMap(ColorMapName::kViridis).at(step > 0 ? 1 : 0))), 2)
        << step;
  }
}

TEST_P(Particles, PlacesThatAreNotFiniteAreLeftOut) {
  const float nan = std::numeric_limits<float>::quiet_NaN(),
              infinite = std::numeric_limits<float>::infinity();
  const std::array<Vec3f, 3> positions{Vec3f{nan, 0, 0}, Vec3f{0, 0, 0}, Vec3f{0, infinite, 0}};
  View view = plainView();
  view.particles = {{.positions = positions, .radius = 0.5f, .fixed = kRed}};
  const Picture picture = renderer.draw(view);
  view.particles[0].positions = std::span(positions).subspan(1, 1);
  EXPECT_EQ(picture.rgb, renderer.draw(view).rgb);
}

TEST_P(Particles, EachFluidHasItsRadiusAndColours) {
  const std::array<Vec3f, 1> left{Vec3f{-1, 0, 0}}, right{Vec3f{1, 0, 0}};
  const std::array<float, 1> value{0};
  View view = plainView();
  view.particles = {{.positions = left, .radius = 0.2f, .fixed = kRed},
                    {.positions = right, .values = value, .radius = 0.6f, .lowest = 0, .highest = 1}};
  const Picture picture = renderer.draw(view);
  const auto at = [&](double x) {
    const auto [px, py] = pixelOf(view, {x, 0, 0}).value();
    return pixelAt(picture, px, py);
  };
  EXPECT_LE(largestDifference(at(-1), toPixel({1, 0, 0})), 2);
  EXPECT_LE(largestDifference(at(1), toPixel(ColorMap(ColorMapName::kViridis).at(0))), 2);
  EXPECT_LE(largestDifference(at(1.5), at(1)), 2) << "within the larger sphere";
  EXPECT_GT(largestDifference(at(-1.5), at(-1)), 100) << "outside of the smaller one";
}

TEST_P(Particles, MoreThanOneBatchAreAllDrawn) {
  // More than are drawn in one go; the last one alone stands in the picture's left half.
  std::vector<Vec3f> positions(300000, Vec3f{1, 0, 0});
  positions.back() = {-1, 0, 0};
  View view = plainView();
  view.particles = {{.positions = positions, .radius = 0.1f, .fixed = kRed}};
  const Picture picture = renderer.draw(view);
  for (const double x : {-1.0, 1.0}) {
    const auto [px, py] = pixelOf(view, {x, 0, 0}).value();
    EXPECT_LT(pixelAt(picture, px, py).g, 5) << x;
  }
}

/// A cloud of white water that fills the picture, with light on.
struct Cloud {
  std::vector<Vec3f> places;
  View view = plainView();

  Cloud() {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> part(-1, 1);
    for (int i = 0; i < 30000; ++i)
      places.push_back({4.5f * part(random), 3.5f * part(random), 0.8f * part(random)});
    view.lighting.unlit = false;
    view.particles = {{.positions = places, .radius = 0.08f, .fixed = {1, 1, 1, 1}, .white = true}};
  }
};

struct Greys {
  int darkest = 765, brightest = 0;
};

Greys greysOf(const Picture& picture) {
  Greys greys;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      greys.darkest = std::min(greys.darkest, pixelAt(picture, x, y).sum());
      greys.brightest = std::max(greys.brightest, pixelAt(picture, x, y).sum());
    }
  return greys;
}

TEST_P(Particles, WhiteWaterIsWhiteWhereverTheSunStands) {
  Cloud cloud;
  for (const Vec3f& sun : {Vec3f{0.3f, 0.5f, 1}, Vec3f{0.3f, 0.5f, -1}, Vec3f{1, 0.2f, 0}}) {
    cloud.view.lighting.towardsSun = sun;
    const Greys greys = greysOf(renderer.draw(cloud.view));
    EXPECT_GT(greys.darkest, 3 * 170) << sun.x << " " << sun.z;
    EXPECT_LT(greys.brightest - greys.darkest, 3 * 50) << sun.x << " " << sun.z;
  }
}

TEST_P(Particles, WhiteWaterInTheShadeIsAsBrightAsTheSkyAbove) {
  Cloud cloud;
  cloud.view.lighting.sunStrength = 0;
  const Greys greys = greysOf(renderer.draw(cloud.view));
  EXPECT_GT(greys.darkest, 3 * 180);
  EXPECT_LT(greys.brightest - greys.darkest, 3 * 20);  // between drops the white background is seen
}

TEST_P(Particles, WhiteWaterCastsNoShadow) {
  const std::array<Vec3f, 1> drop{Vec3f{0, 1, 0}};
  View view = plainView();
  view.camera.eye = {0, 4, 5};
  view.lighting = {.towardsSun = {-1, 1.25f, 0}, .occlusion = false};
  view.ground.visible = true;
  view.particles = {{.positions = drop, .radius = 0.4f, .white = true}};
  const auto [x, y] = pixelOf(view, {0.8, 0, 0}).value();  // where the sun would be hidden
  const Pixel below = pixelAt(renderer.draw(view), x, y);
  view.lighting.shadows = false;
  EXPECT_LE(largestDifference(below, pixelAt(renderer.draw(view), x, y)), 2);
  view.lighting.shadows = true;
  view.particles[0].white = false;
  EXPECT_LT(pixelAt(renderer.draw(view), x, y).sum(), 0.85 * below.sum());
}

}  // namespace
}  // namespace weir::rendering
