// The role of sinks that know how many particles all ranks have removed.
#pragma once

#include <cstdint>

#include "framework/base/api.h"

namespace WEIR_API weir {

/// Counters on devices have 32 bits (SinkPiece::removed). Where ranks share a fluid, it takes what these have
/// counted at every frame, and gives the sum to every rank's sink.
class CountsRemoved {
 public:
  virtual ~CountsRemoved() = default;
  virtual void addRemoved(std::int64_t particles) = 0;
};

}  // namespace weir
