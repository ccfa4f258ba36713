#include "plugins/rendering/gl/particle_colors.h"

#include <algorithm>
#include <cmath>

#include "plugins/rendering/shading/formulas.h"

namespace weir::rendering::gl {

std::vector<std::uint32_t> particleColors(const ParticleView& particles) {
  const float material = particles.white ? shading::kWhite : shading::kParticle;
  std::vector<std::uint32_t> texels;
  const auto byteOf = [](float x) { return std::uint32_t(std::lround(255 * std::clamp(x, 0.0f, 1.0f))); };
  const auto add = [&](const Vec3f& c) {
    texels.push_back(byteOf(c.x) | byteOf(c.y) << 8 | byteOf(c.z) << 16 | byteOf(material) << 24);
  };
  for (int i = 0; i < ColorEntries::kFixed; ++i) add(particles.map.at(float(i) / 255.0f));
  add({particles.fixed.r, particles.fixed.g, particles.fixed.b});
  add(particles.map.at(std::nanf("")));
  return texels;
}

}  // namespace weir::rendering::gl
