#include "plugins/views/surface_foam.h"

#include <atomic>

#include "framework/base/check.h"
#include "nodes/white_water/white_particles.h"
#include "plugins/views/in_parts.h"
#include "plugins/views/near_particles.h"

namespace weir::rendering {

std::vector<float> SurfaceFoam::lay(std::span<const Vec3f> positions, std::span<const float> radii,
                                    std::span<const int> kinds) {
  WEIR_CHECK(positions.size() == radii.size());
  WEIR_CHECK(positions.size() == kinds.size());
  std::vector<Vec3f> places;
  std::vector<std::size_t> numbers;
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    if (kinds[i] != static_cast<int>(WhiteKind::kFoam)) continue;
    places.push_back(positions[i]);
    numbers.push_back(i);
  }
  std::vector<float> left(radii.begin(), radii.end());
  const NearParticles near(places, reach_);
  inParts(vertices_.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v)
      near.visit(vertices_[v], [&](std::size_t k, float weight) {
        const float share = radii[numbers[k]] / reach_;
        cover[v] += 3 * share * share * weight;
        std::atomic_ref(left[numbers[k]]).store(0, std::memory_order_relaxed);
      });
  });
  return left;
}

}  // namespace weir::rendering
