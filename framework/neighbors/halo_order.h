// The order in which searches go over particles that have a halo (ParticleSet::appendHalo): by cells, and in
// each cell owned ones and those of the halo merged by their ids. So a list has the order (cell, id), whoever
// owns the particles in it.
#pragma once

#include "framework/compute/eight.h"

namespace weir {

/// Without a halo: particles stand in the order of the search.
struct InPlace {
  WEIR_HD int particleAt(int place) const { return place; }
  /// Of an owned particle.
  WEIR_HD int placeOf(int particle) const { return particle; }
#ifdef WEIR_HAS_LANES
  LaneInts particlesAt(int place) const {
    return LaneInts::from(place);
  }
#endif
};

/// With one. Owned particles keep their order.
struct MergedOrder {
  /// That many more of `particles` may be read, and are indices.
  static constexpr int kBehind = 32;

  const int* particles = nullptr;  // at each place
  const int* places = nullptr;     // of each owned particle

  WEIR_HD int particleAt(int place) const { return particles[place]; }
  WEIR_HD int placeOf(int particle) const { return places[particle]; }
#ifdef WEIR_HAS_LANES
  LaneInts particlesAt(int place) const {
    return LaneInts::load(particles + place);
  }
#endif
};

/// Merges the particles of cell c; of the last, there is only where it starts.
struct MergeCell {
  ArrayView<const int> owned;  // where cells start, in the order of the owned particles
  ArrayView<const int> halo;   // the same in `haloOrder`
  const int* haloOrder;        // indices in the halo
  int first;                   // the index of the halo's first particle
  ArrayView<const std::int64_t> ids;
  ArrayView<int> start;  // what is made: where cells start, and a MergedOrder
  int* particles;
  int* places;

  WEIR_HD void operator()(std::int64_t c) const {
    int j = owned[c], k = halo[c], place = j + k;
    start[c] = place;
    if (c + 1 == start.size) return;
    for (const int end = owned[c + 1], haloEnd = halo[c + 1]; j < end || k < haloEnd; ++place) {
      const int other = k < haloEnd ? first + haloOrder[k] : -1;
      const bool takesOwned = other < 0 || (j < end && ids[j] < ids[other]);
      particles[place] = takesOwned ? j : other;
      if (takesOwned)
        places[j++] = place;
      else
        ++k;
    }
  }
};

/// The ids of particles, from one of them on.
struct IdsFrom {
  ArrayView<const std::int64_t> ids;
  std::int64_t first = 0;
  WEIR_HD std::int64_t operator()(std::int64_t i) const { return ids[first + i]; }
};

/// Puts the particles of each cell into the order of their ids, where order[k] for start[c] ≤ k < start[c +
/// 1] are those of cell c; the id of particle order[k] is ids(order[k]).
template <class Ids>
struct OrderCellByIds {
  ArrayView<const int> start;
  ArrayView<int> order;
  Ids ids;

  WEIR_HD void operator()(std::int64_t c) const {
    // Few, and mostly in order.
    for (int end = start[c] + 1; end < start[c + 1]; ++end) {
      const int moved = order[end];
      const std::int64_t id = ids(moved);
      int k = end;
      for (; k > start[c] && ids(order[k - 1]) > id; --k) order[k] = order[k - 1];
      order[k] = moved;
    }
  }
};

}  // namespace weir
