// The role of nodes whose particles ranks share, for whoever runs them.
#pragma once

#include "framework/base/api.h"
#include "framework/base/value.h"

namespace WEIR_API weir {

class SharedByRanks {
 public:
  virtual ~SharedByRanks() = default;
  /// Whether something looks at every frame on rank 0, which needs the particles of all ranks for that.
  /// Reports and checkpoints (checkpoints_by_ranks.h) do without. Before the first reset, on all ranks alike.
  virtual void watch(bool watched) = 0;
  /// How the ranks fare, as of the last frame: an object of numbers, for --stats. Empty without ranks.
  virtual Value ranksReport() const = 0;
};

}  // namespace weir
