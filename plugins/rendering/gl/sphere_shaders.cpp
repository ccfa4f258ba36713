#include "plugins/rendering/gl/sphere_shaders.h"

namespace weir::rendering::gl {

std::vector<std::uint32_t> cornerIndices(int particles) {
  std::vector<std::uint32_t> indices;
  indices.reserve(6 * std::size_t(particles));
  for (std::uint32_t first = 0; first < 4 * std::uint32_t(particles); first += 4)
    for (const std::uint32_t k : {0u, 1u, 2u, 2u, 1u, 3u}) indices.push_back(first + k);
  return indices;
}

}  // namespace weir::rendering::gl
