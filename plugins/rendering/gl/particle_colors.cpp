#include "plugins/rendering/gl/particle_colors.h"

#include <algorithm>
#include <cmath>

namespace weir::rendering::gl {

std::vector<std::uint8_t> particleColors(const ParticleView& particles) {
  std::vector<std::uint8_t> texels;
  const auto add = [&](const Vec3f& color) {
    for (const float c : {color.x, color.y, color.z, 1.0f})
      texels.push_back(std::uint8_t(std::lround(255.0f * std::clamp(c, 0.0f, 1.0f))));
  };
  for (int i = 0; i < ColorEntries::kFixed; ++i) add(particles.map.at(float(i) / 255.0f));
  add({particles.fixed.r, particles.fixed.g, particles.fixed.b});
  add(particles.map.at(std::nanf("")));
  return texels;
}

}  // namespace weir::rendering::gl
