// In which order spheres are splatted. On CUDA in small groups from all over the fluid (Shares). On the CPU
// the nearest groups come first, in rounds, and groups that a round has hidden are left out of the next.
#pragma once

#include <algorithm>
#include <string_view>
#include <type_traits>
#include <vector>

#include "framework/compute/parallel.h"
#include "plugins/rendering/compute/sphere_kernels.h"
#include "plugins/rendering/gl/splat_rows.h"

namespace weir::rendering::gl {

/// A ball around Shares::kGroup spheres that are neighbours in memory, and so usually in space.
struct SphereGroup {
  Vec3f center;
  float radius = 0;  ///< 0: there are none
};

struct FindGroup {
  ArrayView<const SplatSphere> spheres;
  ArrayView<SphereGroup> groups;

  WEIR_HD void operator()(std::int64_t k) const {
    Aabb box;
    float largest = 0;
    for (std::int64_t i = k * Shares::kGroup; i < (k + 1) * Shares::kGroup && i < spheres.size; ++i) {
      if (!(spheres[i].radius > 0)) continue;
      box.extend(spheres[i].center);
      largest = spheres[i].radius > largest ? spheres[i].radius : largest;
    }
    if (largest > 0)
      groups[k] = {box.center(), 0.5f * length(box.size()) + largest};
    else
      groups[k] = {};
  }
};

/// The distances of groups to the eye, in any unit.
template <class Offer>
struct FindDistance {
  Offer offer;
  ArrayView<const SphereGroup> groups;
  ArrayView<float> distances;

  WEIR_HD void operator()(std::int64_t k) const { distances[k] = offer.distanceTo(groups[k]); }
};

/// The numbers of groups, the nearest first; about in order is enough.
inline std::vector<int> nearestFirst(ArrayView<const float> distances) {
  constexpr int kBins = 256;
  const auto [low, high] = std::minmax_element(distances.data, distances.data + distances.size);
  const float scale = *high > *low ? (kBins - 1) / (*high - *low) : 0.0f;
  const auto binOf = [&, lowest = *low](std::int64_t k) {
    return std::clamp(static_cast<int>((distances[k] - lowest) * scale), 0, kBins - 1);
  };
  std::vector<int> ends(kBins + 1), order(static_cast<std::size_t>(distances.size));
  for (std::int64_t k = 0; k < distances.size; ++k) ++ends[static_cast<std::size_t>(binOf(k)) + 1];
  for (std::size_t bin = 0; bin < kBins; ++bin) ends[bin + 1] += ends[bin];
  for (std::int64_t k = 0; k < distances.size; ++k)
    order[static_cast<std::size_t>(ends[static_cast<std::size_t>(binOf(k))]++)] = static_cast<int>(k);
  return order;
}

/// Some spheres of a group, unless the whole group is hidden.
template <class Offer>
struct OfferSlice {
  Offer offer;
  FarthestTiles tiles;
  ArrayView<const SphereGroup> groups;
  const int* order;
  std::int64_t first;  ///< slice
  int slices, parts;   ///< of each group; of each sphere

  WEIR_HD void operator()(std::int64_t later) const {
    const std::int64_t k = (first + later) / parts, slice = k % slices;
    const int group = order[k / slices];
    if (offer.hidden(groups[group], tiles)) return;
    const std::int64_t each = Shares::kGroup / slices, start = group * Shares::kGroup + slice * each;
    for (std::int64_t i = start; i < start + each && i < offer.spheres.size; ++i)
      offer(i, static_cast<int>((first + later) % parts), parts, tiles);
  }
};

template <class Offer>
struct OfferShare {
  Offer offer;
  Shares shares;

  WEIR_HD void operator()(std::int64_t k) const {
    const std::int64_t i = shares.sphere(k);
    if (i < shares.spheres) offer(i, shares.part(k), shares.parts, FarthestTiles{});
  }
};

template <class Least, class Offer>
void offerNearestFirst(CpuBackend& device, std::string_view name, ArrayView<Least> min, int width,
                       const Offer& offer) {
  constexpr std::int64_t kMin = 4096;  // elements of a round: enough for all threads
  const ArrayView<const SplatSphere> spheres = offer.spheres;
  Array<SphereGroup> found(device, (spheres.size + Shares::kGroup - 1) / Shares::kGroup);
  const ArrayView<const SphereGroup> groups = static_cast<const Array<SphereGroup>&>(found).view();
  parallelFor(device, "group spheres", groups.size, FindGroup{spheres, found.view()});
  Array<float> distances(device, groups.size);
  parallelFor(device, "group spheres", groups.size, FindDistance<Offer>{offer, groups, distances.view()});
  const std::vector<int> order = nearestFirst(static_cast<const Array<float>&>(distances).view());

  const int height = static_cast<int>(min.size / width);
  const auto tilesAlong = [](int samples) { return (samples - 1) / FarthestTiles::kSide + 1; };
  Array<float> farthest(device, std::int64_t{tilesAlong(width)} * tilesAlong(height));
  OfferSlice<Offer> slices{.offer = offer,
                           .tiles = {.perRow = tilesAlong(width)},
                           .groups = groups,
                           .order = order.data(),
                           .slices = groups.size < 4096 ? 8 : 1,
                           .parts = spheres.size < 8192 ? 8 : 1};
  const std::int64_t count = groups.size * slices.slices * slices.parts;
  for (std::int64_t behind = std::max(count / 12, kMin); slices.first < count; behind *= 3) {
    behind = std::min(behind, count);
    parallelFor(device, name, behind - slices.first, slices);
    slices.first = behind;
    if (behind == count) break;
    parallelFor(device, "farthest", farthest.size(),
                FindFarthest<Least>{min.data, width, height, slices.tiles.perRow, farthest.data()});
    slices.tiles.farthest = static_cast<const Array<float>&>(farthest).view();
  }
}

/// Offers every sphere of `offer` to `min`, rows of `width` samples.
template <class Backend, class Least, class Offer>
void offerAll(Backend& device, std::string_view name, ArrayView<Least> min, int width, const Offer& offer) {
  if (offer.spheres.size == 0) return;
  if constexpr (std::is_base_of_v<CpuBackend, Backend>) {
    offerNearestFirst(device, name, min, width, offer);
  } else {
    const Shares shares(offer.spheres.size);
    parallelFor(device, name, shares.count(), OfferShare<Offer>{offer, shares});
  }
}

}  // namespace weir::rendering::gl
