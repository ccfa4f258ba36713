// What the ranks that share a fluid have found together at the last frame.
#pragma once

#include <cstdint>

#include "framework/base/value.h"
#include "nodes/particle_fluid/fluid_statistics.h"

namespace weir {

struct FrameOnRanks {
  std::int64_t particles = 0;  ///< of all ranks
  FluidSums sums;
  Value report = Value::object();  ///< for SharedByRanks::ranksReport()
};

}  // namespace weir
