// What neighbour lists hold, on the host.
#pragma once

#include <set>
#include <utility>
#include <vector>

#include "nodes/particles/neighbor_list.h"

namespace weir::test {

using Pairs = std::set<std::pair<int, int>>;  // of ids

inline Pairs listedPairs(ParticleSet& particles, const NeighborList& list) {
  const std::int64_t n = particles.refreshCount();
  const std::vector<int> ids = particles.ids().toHost(n);
  // The lists live on the device; they are read through the same view, from a copy.
  const NeighborView view = list.view();
  const std::int64_t lanes = std::int64_t{1} << view.shift;
  std::vector<int> counts(n), entries((n + lanes - 1) / lanes * lanes * view.capacity);
  particles.device().download(counts.data(), view.counts, counts.size() * sizeof(int));
  particles.device().download(entries.data(), view.entries, entries.size() * sizeof(int));
  const NeighborView onHost{entries.data(), counts.data(), view.capacity, view.shift};
  Pairs pairs;
  for (std::int64_t i = 0; i < n; ++i)
    forEachNeighbor(i, onHost, [&](int j) { pairs.emplace(ids[i], ids[j]); });
  return pairs;
}

}  // namespace weir::test
