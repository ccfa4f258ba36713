// What the ranks that share a fluid have found together at the last frame.
#pragma once

#include <cstdint>

#include "framework/base/value.h"
#include "nodes/particle_fluid/fluid_statistics.h"

namespace weir {

/// NeighborEvents of all ranks together.
struct EventsOfAll {
  std::int64_t truncated = 0, escaped = 0, nonFinite = 0, cutOffByOrder = 0;
};

struct FrameOnRanks {
  std::int64_t particles = 0;  ///< of all ranks
  FluidSums sums;
  EventsOfAll events;
  Value report = Value::object();  ///< for SharedByRanks::ranksReport()
};

}  // namespace weir
