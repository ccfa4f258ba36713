// Which spheres are nearest, against looking at all of them; and the squares of a shadow map.
#include "plugins/rendering/gl/splat_kernels.h"
#include "framework/compute/dispatch.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <random>

#include "plugins/rendering/compute/shadow_tiles.h"
#include "tests/plugins/rendering/gl/pictures.h"

namespace weir::rendering {
namespace {

class SplatKernels : public testing::TestWithParam<std::string> {
 protected:
  std::unique_ptr<Device> device = openDevice(GetParam());
  std::mt19937 random{11};

  float between(float low, float high) { return std::uniform_real_distribution<float>(low, high)(random); }

  /// Layers of small spheres, row by row, of which most are hidden, in a box of 2 m before the eye. Some are
  /// nowhere.
  std::vector<SplatSphere> layers() {
    constexpr int kSide = 34;  // more than come in one round
    std::vector<SplatSphere> spheres;
    for (int i = 0; i < kSide * kSide * kSide; ++i) {
      const Vec3f cell{float(i % kSide), float(i / kSide % kSide), float(i / kSide / kSide)};
      const Vec3f jitter{between(0, 1), between(0, 1), between(0, 1)};
      const Vec3f place = (cell + jitter) * (2.0f / kSide) - Vec3f{1, 1, 4};
      spheres.push_back({place, i % 97 == 0 ? 0.0f : between(0.03f, 0.045f), static_cast<std::uint32_t>(i)});
    }
    return spheres;
  }

  static gl::SplatCamera camera() {
    constexpr float kNear = 0.5f, kFar = 10;
    return {.view = {.rows = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}},
            .tangent = {0.125f, 0.08f},
            .projection = {8, 12.5f, (kFar + kNear) / (kNear - kFar), 2 * kFar * kNear / (kNear - kFar)},
            .near = kNear,
            .width = 45,
            .height = 29};
  }
};

INSTANTIATE_TEST_SUITE_P(Devices, SplatKernels, testing::ValuesIn(test::availableDevices()),
                         [](const auto& tested) { return tested.param; });

/// Along the axis; infinite for a miss.
double distanceAlong(const Vec3f& ray, const SplatSphere& sphere) {
  const Vec3d r{ray.x, ray.y, ray.z}, c{sphere.center.x, sphere.center.y, sphere.center.z};
  const double a = dot(r, r), b = dot(r, c);
  const double inside = b * b - a * (dot(c, c) - double(sphere.radius) * sphere.radius);
  return sphere.radius > 0 && inside >= 0 ? (b - std::sqrt(inside)) / a : HUGE_VAL;
}

TEST_P(SplatKernels, FindTheNearestSphereAtEachSample) {
  const std::vector<SplatSphere> spheres = layers();
  const gl::SplatCamera seenBy = camera();
  const std::int64_t count = std::int64_t{seenBy.width} * seenBy.height;
  constexpr std::uint64_t kNothing = std::uint64_t{0x3f800000} << 32 | gl::kNoSphere;
  Array<std::uint64_t> nearest(*device,
                               std::vector<std::uint64_t>(static_cast<std::size_t>(count), kNothing));
  const Array<SplatSphere> all(*device, std::span<const SplatSphere>(spheres));
  dispatch(*device, [&](auto& at) { gl::splatDepths(at, all.view(), seenBy, nearest.view()); });
  const std::vector<std::uint64_t> found = nearest.toHost();
  int seen = 0, wrong = 0;
  for (int y = 0; y < seenBy.height; ++y)
    for (int x = 0; x < seenBy.width; ++x) {
      const Vec3f ray = seenBy.ray(x, y);
      double wanted = HUGE_VAL;
      for (const SplatSphere& sphere : spheres) wanted = std::min(wanted, distanceAlong(ray, sphere));
      const std::uint64_t one =
          found[static_cast<std::size_t>(y) * std::size_t(seenBy.width) + std::size_t(x)];
      if (one == kNothing) {
        wrong += wanted < HUGE_VAL;
        continue;
      }
      ++seen;
      const std::uint32_t number = gl::kNoSphere - 1 - static_cast<std::uint32_t>(one);
      ASSERT_LT(number, spheres.size());
      const double depth = seenBy.depthAt(static_cast<float>(wanted));
      const bool sphereIsRight = std::fabs(distanceAlong(ray, spheres[number]) - wanted) < 1e-5;
      const bool depthIsRight =
          std::fabs(std::bit_cast<float>(static_cast<std::uint32_t>(one >> 32)) - depth) < 2e-6;
      wrong += !(sphereIsRight && depthIsRight);
    }
  EXPECT_GT(seen, count / 2);
  EXPECT_LE(wrong, 3);  // rays that graze a sphere
}

TEST_P(SplatKernels, FindTheDepthsThatTheSunSees) {
  const std::vector<SplatSphere> spheres = layers();
  const gl::SplatSun sun{.toClip = {.rows = {{2, 0, 0}, {0, 2, 0}, {0, 0, -0.5f}}, .moved = {0, 0, -1.5f}},
                         .halfSize = 0.5f,
                         .zToDepth = 0.5f,
                         .resolution = 37};
  Array<std::uint32_t> bits(*device, std::int64_t{sun.resolution} * sun.resolution);
  const Array<SplatSphere> all(*device, std::span<const SplatSphere>(spheres));
  dispatch(*device, [&](auto& at) {
    gl::clearDepths(at, bits.view());
    gl::splatSunDepths(at, all.view(), sun, bits.view());
  });
  const std::vector<std::uint32_t> found = bits.toHost();
  int wrong = 0, seen = 0;
  for (int y = 0; y < sun.resolution; ++y)
    for (int x = 0; x < sun.resolution; ++x) {
      const double u = 0.5 * ((x + 0.5) * 2 / sun.resolution - 1),
                   v = 0.5 * ((y + 0.5) * 2 / sun.resolution - 1);
      double wanted = 1;
      for (const SplatSphere& sphere : spheres) {
        const double a = u - sphere.center.x, b = v - sphere.center.y;
        const double rest = double(sphere.radius) * sphere.radius - a * a - b * b;
        if (!(sphere.radius > 0) || rest < 0) continue;
        wanted = std::min(wanted, 0.5 + 0.5 * (-1.5 - 0.5 * (sphere.center.z + std::sqrt(rest))));
      }
      seen += wanted < 1;
      const std::size_t at = static_cast<std::size_t>(y) * std::size_t(sun.resolution) + std::size_t(x);
      wrong += std::fabs(std::bit_cast<float>(found[at]) - wanted) > 1e-5;
    }
  EXPECT_GT(seen, sun.resolution * sun.resolution / 8);
  EXPECT_LE(wrong, 3);
}

TEST_P(SplatKernels, KnowTheDepthsAroundEachSquareOfAShadowMap) {
  constexpr int kResolution = 53;
  std::vector<float> map(kResolution * kResolution);
  for (float& depth : map) depth = between(0, 1);
  const Array<float> shadow(*device, std::span<const float>(map));
  const int perRow = ShadowTiles::perRowOf(kResolution);
  ASSERT_EQ(perRow, 7);
  Array<Vec2f> tiles(*device, perRow * perRow), scratch(*device, perRow * perRow);
  dispatch(*device,
           [&](auto& at) { findShadowTiles(at, shadow.view(), kResolution, tiles.view(), scratch.view()); });
  const std::vector<Vec2f> found = tiles.toHost();
  for (int row = 0; row < perRow; ++row)
    for (int column = 0; column < perRow; ++column) {
      float low = 1, high = 0;
      for (int y = std::max(0, 8 * row - 8); y < std::min(kResolution, 8 * row + 16); ++y)
        for (int x = std::max(0, 8 * column - 8); x < std::min(kResolution, 8 * column + 16); ++x) {
          low = std::min(low, map[static_cast<std::size_t>(y * kResolution + x)]);
          high = std::max(high, map[static_cast<std::size_t>(y * kResolution + x)]);
        }
      EXPECT_EQ(found[static_cast<std::size_t>(row * perRow + column)], (Vec2f{low, high}));
    }
}

}  // namespace
}  // namespace weir::rendering
