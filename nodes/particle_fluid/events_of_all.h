// What the searches of all ranks have met since the reset.
#pragma once

#include <cstdint>

#include "framework/neighbors/neighbor_list.h"

namespace weir {

/// NeighborEvents of all ranks together, and of all runs that went on from each other's checkpoints.
struct EventsOfAll {
  std::int64_t truncated = 0, escaped = 0, nonFinite = 0, cutOffByOrder = 0;

  static EventsOfAll of(const NeighborEvents& events) {
    return {events.truncated, events.escaped, events.nonFinite, events.cutOffByOrder};
  }
};

}  // namespace weir
