// What neighbour lists hold, on the host.
#pragma once

#include <set>
#include <utility>
#include <vector>

#include "framework/neighbors/neighbor_list.h"

namespace weir::test {

using Pairs = std::set<std::pair<std::int64_t, std::int64_t>>;  // of ids

inline Pairs listedPairs(ParticleSet& particles, const NeighborList& list) {
  const std::int64_t n = particles.refreshCount();
  const std::vector<std::int64_t> ids = particles.ids().toHost(n);
  const std::vector<std::vector<int>> lists = list.listsOnHost(n);
  Pairs pairs;
  for (std::int64_t i = 0; i < n; ++i)
    for (const int j : lists[i]) pairs.emplace(ids[i], ids[j]);
  return pairs;
}

}  // namespace weir::test
