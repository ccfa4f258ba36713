// The role of nodes whose particles ranks share, for whoever runs them.
#pragma once

#include "framework/base/api.h"
#include "framework/base/value.h"

namespace WEIR_API weir {

/// What on rank 0 needs the particles of all ranks. Numbers of reports need no such thing.
struct WatchedByRanks {
  bool frames = true;       ///< something that looks at every frame
  bool checkpoints = true;  ///< what is saved at some of them, after SharedByRanks::gather()
};

class SharedByRanks {
 public:
  virtual ~SharedByRanks() = default;
  /// Before the first reset, on all ranks alike.
  virtual void watch(WatchedByRanks watched) = 0;
  /// On all ranks at the same frame: what rank 0 saves then has the particles of all.
  virtual void gather() = 0;
  /// How the ranks fare, as of the last frame: an object of numbers, for --stats. Empty without ranks.
  virtual Value ranksReport() const = 0;
};

}  // namespace weir
