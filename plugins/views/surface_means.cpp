#include "plugins/views/surface_means.h"

#include "framework/base/check.h"
#include "plugins/views/in_parts.h"

namespace weir::rendering {

std::vector<Vec3f> meansAt(std::span<const Vec3f> places, const NearParticles& particles,
                           std::span<const Vec3f> vectors) {
  WEIR_CHECK(vectors.size() == particles.size());
  std::vector<Vec3f> means(places.size());
  inParts(places.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Vec3f sum;
      float weights = 0;
      particles.visit(places[i], [&](std::size_t k, float weight) {
        if (!isFinite(vectors[k])) return;
        sum += weight * vectors[k];
        weights += weight;
      });
      if (weights > 0) means[i] = (1 / weights) * sum;
    }
  });
  return means;
}

}  // namespace weir::rendering
