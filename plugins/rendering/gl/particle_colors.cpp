#include "plugins/rendering/gl/particle_colors.h"

#include <algorithm>
#include <cmath>

namespace weir::rendering::gl {

namespace {

constexpr int kMapSize = 256;
constexpr float kUnknownEntry = 257;

}  // namespace

ParticleColors::ParticleColors(const ParticleView& particles)
    : lowest_(particles.lowest), highest_(particles.highest) {
  const auto add = [&](float r, float g, float b) {
    for (const float c : {r, g, b, 1.0f})
      texels_.push_back(std::uint8_t(std::lround(255.0f * std::clamp(c, 0.0f, 1.0f))));
  };
  for (int i = 0; i < kMapSize; ++i) {
    const Vec3f color = particles.map.at(float(i) / 255.0f);
    add(color.x, color.y, color.z);
  }
  add(particles.fixed.r, particles.fixed.g, particles.fixed.b);
  const Vec3f unknown = particles.map.at(std::nanf(""));
  add(unknown.x, unknown.y, unknown.z);
}

float ParticleColors::entryOf(float value) const {
  if (std::isnan(value)) return kUnknownEntry;
  const float range = highest_ - lowest_;
  const float t = range > 0 ? (value - lowest_) / range : (value == lowest_ ? 0.5f : float(value > lowest_));
  return 255.0f * std::clamp(t, 0.0f, 1.0f);
}

std::array<std::uint8_t, 3> ParticleColors::at(float entry) const {
  const int first = std::clamp(int(entry), 0, kCount - 2);
  const float part = entry - float(first);
  std::array<std::uint8_t, 3> color;
  for (int c = 0; c < 3; ++c) {
    const float a = texels_[std::size_t(4 * first + c)], b = texels_[std::size_t(4 * first + 4 + c)];
    color[std::size_t(c)] = std::uint8_t(a + (b - a) * part + 0.5f);
  }
  return color;
}

}  // namespace weir::rendering::gl
