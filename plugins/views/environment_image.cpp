#include "plugins/views/environment_image.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace weir::rendering {

namespace {

constexpr int kTerms = 9;

/// The real spherical harmonics of degree 0 to 2.
std::array<double, kTerms> harmonics(const Vec3d& d) {
  return {0.282095,
          0.488603 * d.y,
          0.488603 * d.z,
          0.488603 * d.x,
          1.092548 * d.x * d.y,
          1.092548 * d.y * d.z,
          0.315392 * (3 * d.z * d.z - 1),
          1.092548 * d.x * d.z,
          0.546274 * (d.x * d.x - d.y * d.y)};
}

/// The quadratic form of light with these coefficients, spread by the cosine law and divided by pi.
std::array<float, 16> formOf(const std::array<double, kTerms>& c) {
  constexpr double kFirst = 2.0 / 3, kSecond = 0.25;  // of degree 1 and 2
  const double constant = 0.282095 * c[0] - kSecond * 0.315392 * c[6];
  const double x = 0.5 * kFirst * 0.488603 * c[3], y = 0.5 * kFirst * 0.488603 * c[1],
               z = 0.5 * kFirst * 0.488603 * c[2];
  const double half = 0.5 * kSecond * 1.092548, squares = kSecond * 0.546274 * c[8];
  const double xy = half * c[4], yz = half * c[5], xz = half * c[7], zz = 3 * kSecond * 0.315392 * c[6];
  const std::array<double, 16> form{squares, xy, xz, x, xy, -squares, yz, y,
                                    xz,      yz, zz, z, x,  y,        z,  constant};
  std::array<float, 16> rounded{};
  std::transform(form.begin(), form.end(), rounded.begin(), [](double v) { return static_cast<float>(v); });
  return rounded;
}

float luminance(const Vec3f& light) {
  return 0.2126f * light.x + 0.7152f * light.y + 0.0722f * light.z;
}

}  // namespace

Vec3f EnvironmentImage::directionOf(int column, int row) const {
  constexpr float kPi = std::numbers::pi_v<float>;
  const float a = 2 * kPi * ((static_cast<float>(column) + 0.5f) / static_cast<float>(width) - 0.5f);
  const float b = kPi * ((static_cast<float>(row) + 0.5f) / static_cast<float>(height) - 0.5f);
  return {std::sin(a) * std::cos(b), std::sin(b), std::cos(a) * std::cos(b)};
}

void findAmbient(EnvironmentImage& image) {
  constexpr float kBrightest = 4;   // of what is not the sun
  constexpr float kSunPart = 0.5f;  // of the brightest light
  float brightest = 0;
  for (const Vec3f& light : image.light) brightest = std::max(brightest, luminance(light));
  std::array<std::array<double, kTerms>, 3> sums{};
  Vec3d mean, sun;
  double whole = 0;
  for (int row = 0; row < image.height; ++row)
    for (int column = 0; column < image.width; ++column) {
      const Vec3f direction = image.directionOf(column, row);
      const Vec3d d{direction.x, direction.y, direction.z};
      const double size = std::sqrt(std::max(0.0, 1 - d.y * d.y));  // of the texel, seen from the middle
      const Vec3f& light = image.light[static_cast<std::size_t>(row) * static_cast<std::size_t>(image.width) +
                                       static_cast<std::size_t>(column)];
      const float bright = luminance(light);
      if (bright > kSunPart * brightest) sun += d * (size * bright);
      const double kept = bright > kBrightest ? kBrightest / bright : 1;
      const std::array<double, kTerms> y = harmonics(d);
      for (int c = 0; c < 3; ++c)
        for (int k = 0; k < kTerms; ++k) sums[c][k] += size * kept * light[c] * y[k];
      mean += Vec3d{light.x, light.y, light.z} * (size * kept);
      whole += size;
    }
  const double scale = 4 * std::numbers::pi / whole;
  for (int c = 0; c < 3; ++c) {
    for (double& sum : sums[c]) sum *= scale;
    image.ambient[c] = formOf(sums[c]);
  }
  mean = mean / whole;
  image.mean = {static_cast<float>(mean.x), static_cast<float>(mean.y), static_cast<float>(mean.z)};
  const Vec3f middle{static_cast<float>(sun.x), static_cast<float>(sun.y), static_cast<float>(sun.z)};
  image.towardsSun = length(middle) > 0 ? normalized(middle) : Vec3f{0, 1, 0};
}

}  // namespace weir::rendering
