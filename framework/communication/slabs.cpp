#include "framework/communication/slabs.h"

#include <algorithm>
#include <numeric>

#include "framework/base/check.h"

namespace weir {

namespace {

/// Fills slab after slab up to `max` particles; returns where the next ones begin.
std::vector<std::size_t> fill(std::span<const std::int64_t> particles, std::int64_t max) {
  std::vector<std::size_t> begins;
  std::int64_t inSlab = 0;
  for (std::size_t layer = 0; layer < particles.size(); ++layer) {
    if (inSlab + particles[layer] > max) begins.push_back(layer), inSlab = 0;
    inSlab += particles[layer];
  }
  return begins;
}

}  // namespace

std::vector<int> Slabs::neighborsOf(int k) const {
  const auto begin = [&](int slab) { return cuts[std::size_t(slab) - 1]; };
  const auto isEmpty = [&](int slab) {
    return slab > 0 && slab + 1 < count() && begin(slab) == begin(slab + 1);
  };
  std::vector<int> found;
  if (isEmpty(k)) return found;
  if (k > 0) found.push_back(view().slabOfLayer(begin(k) - 1));
  if (k + 1 < count()) found.push_back(view().slabOfLayer(begin(k + 1)));
  return found;
}

std::vector<int> cutLayers(int firstLayer, std::span<const std::int64_t> particles, int slabs) {
  WEIR_CHECK(slabs > 0);
  const std::int64_t all = std::accumulate(particles.begin(), particles.end(), std::int64_t{0});
  std::int64_t low = particles.empty() ? 0 : *std::max_element(particles.begin(), particles.end());
  std::int64_t high = std::max(low, all);
  while (low < high) {
    const std::int64_t middle = low + (high - low) / 2;
    if (static_cast<int>(fill(particles, middle).size()) < slabs)
      high = middle;
    else
      low = middle + 1;
  }
  std::vector<int> cuts;
  for (const std::size_t begin : fill(particles, high)) cuts.push_back(firstLayer + static_cast<int>(begin));
  // What is left over lies behind all particles, or before them if there are none.
  cuts.resize(std::size_t(slabs) - 1, firstLayer + static_cast<int>(particles.size()));
  return cuts;
}

}  // namespace weir
