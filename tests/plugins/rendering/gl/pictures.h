// What the tests of the renderer share: small views, and reading pictures.
#pragma once

#include <cmath>
#include <cstdlib>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "plugins/rendering/gl/context.h"
#include "plugins/rendering/gl/renderer.h"
#include "tests/support/devices.h"

namespace weir::rendering {

inline const std::string kOpenGl = "OpenGL";

/// The ways in which particles come into a picture: by OpenGL, and on each device.
inline std::vector<std::string> particleDrawers() {
  std::vector<std::string> names = test::availableDevices();
  names.insert(names.begin(), kOpenGl);
  return names;
}
/// For a renderer of that kind.
inline std::unique_ptr<Device> splatDevice(const std::string& drawer) {
  return drawer == kOpenGl ? nullptr : openDevice(drawer);
}

struct Pixel {
  int r, g, b;
  int sum() const { return r + g + b; }
};

inline Pixel pixelAt(const Picture& picture, int x, int y) {
  const std::uint8_t* p = &picture.rgb.at(3 * (std::size_t(y) * std::size_t(picture.width) + std::size_t(x)));
  return {p[0], p[1], p[2]};
}

inline int largestDifference(const Pixel& a, const Pixel& b) {
  return std::max({std::abs(a.r - b.r), std::abs(a.g - b.g), std::abs(a.b - b.b)});
}

inline int largestDifference(const Picture& a, const Picture& b) {
  int largest = a.rgb.size() == b.rgb.size() ? 0 : 256;
  for (std::size_t i = 0; largest < 256 && i < a.rgb.size(); ++i)
    largest = std::max(largest, std::abs(int(a.rgb[i]) - int(b.rgb[i])));
  return largest;
}

inline Pixel toPixel(const Vec3f& color) {
  return {int(std::lround(255 * color.x)), int(std::lround(255 * color.y)), int(std::lround(255 * color.z))};
}

/// A camera on the z axis that looks at the origin; one colour behind; no ground, no light: plain colours.
inline View plainView(int width = 160, int height = 120) {
  View view;
  view.width = width;
  view.height = height;
  view.camera = {.eye = {0, 0, 5}, .target = {}, .up = {0, 1, 0}, .fovDegrees = 60};
  view.backgroundTop = view.backgroundBottom = {1, 1, 1, 1};
  view.ground.visible = false;
  view.lighting.unlit = true;
  return view;
}

/// The pixel that shows a point, by a projection of the test's own. The camera must not be rolled: `up` is y.
inline std::optional<std::pair<int, int>> pixelOf(const View& view, const Vec3d& point) {
  const auto toDouble = [](const Vec3f& v) { return Vec3d{v.x, v.y, v.z}; };
  const Vec3d eye = toDouble(view.camera.eye);
  const Vec3d ahead = normalized(toDouble(view.camera.target) - eye);
  const Vec3d right = normalized(cross(ahead, Vec3d{0, 1, 0}));
  const Vec3d q = point - eye;
  const double depth = dot(q, ahead);
  if (depth <= 0) return std::nullopt;
  const double perPixel = 2 * std::tan(view.camera.fovDegrees * std::numbers::pi / 360) / double(view.height);
  const double x = dot(q, right) / depth / perPixel, y = dot(q, cross(right, ahead)) / depth / perPixel;
  return std::pair{int(std::floor(view.width / 2.0 + x)), int(std::floor(view.height / 2.0 - y))};
}

inline TriangleMesh quad(const Vec3f& a, const Vec3f& b, const Vec3f& c, const Vec3f& d) {
  return {{a, b, c, d}, {{0, 1, 2}, {0, 2, 3}}};
}

}  // namespace weir::rendering
