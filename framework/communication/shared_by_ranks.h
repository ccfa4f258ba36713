// The role of nodes whose particles ranks share, for whoever runs them.
#pragma once

#include "framework/base/api.h"
#include "framework/base/value.h"

namespace WEIR_API weir {

/// What on rank 0 needs the particles of all ranks. Numbers of reports need no such thing, nor do checkpoints
/// (checkpoints_by_ranks.h).
struct WatchedByRanks {
  bool frames = true;       ///< something that looks at every frame
  bool checkpoints = true;  ///< means nothing; here for plugins that are built
};

class SharedByRanks {
 public:
  virtual ~SharedByRanks() = default;
  /// Before the first reset, on all ranks alike.
  virtual void watch(WatchedByRanks watched) = 0;
  /// Nobody calls it; here for plugins that are built.
  virtual void gather() {}
  /// How the ranks fare, as of the last frame: an object of numbers, for --stats. Empty without ranks.
  virtual Value ranksReport() const = 0;
};

}  // namespace weir
