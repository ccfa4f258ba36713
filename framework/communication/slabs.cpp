#include "framework/communication/slabs.h"

#include <algorithm>
#include <numeric>

#include "framework/base/check.h"

namespace weir {

namespace {

// Layers beside a box, of those that it has, and how many at least.
constexpr int kPartForRoom = 8, kMinRoom = 4;

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

CellLayers layersAcross(const Aabb& box, float cellSize) {
  constexpr int kMaxLayers = 1 << 16;
  const Vec3f size = box.size();
  CellLayers layers{.axis = size.x > std::max(size.y, size.z) ? 0 : (size.y > size.z ? 1 : 2),
                    .inverseCellSize = 1.0f / cellSize};
  const int low = layers.countedLayerOf(box.lo), high = layers.countedLayerOf(box.hi);
  const int room = kMinRoom + (high - low) / kPartForRoom;
  layers.first = low - room;
  layers.count = std::min(high - low + 1 + 2 * room, kMaxLayers);
  return layers;
}

CellLayers Slabs::layersOf(int k) const {
  CellLayers own = layers;
  if (k > 0) own.first = cuts[std::size_t(k) - 1];
  const int end = k + 1 < count() ? cuts[std::size_t(k)] : layers.first + layers.count;
  own.count = end - own.first;
  return own;
}

std::optional<int> Slabs::below(int k) const {
  if (layersOf(k).count == 0) return {};
  while (--k >= 0)
    if (layersOf(k).count > 0) return k;
  return {};
}

std::optional<int> Slabs::above(int k) const {
  if (layersOf(k).count == 0) return {};
  while (++k < count())
    if (layersOf(k).count > 0) return k;
  return {};
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
