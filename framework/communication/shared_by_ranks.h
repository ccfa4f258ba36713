// The role of nodes whose particles ranks share, for whoever runs them.
#pragma once

#include "framework/base/api.h"
#include "framework/base/value.h"

namespace WEIR_API weir {

class SharedByRanks {
 public:
  virtual ~SharedByRanks() = default;
  /// Before the first reset, on all ranks alike: whether something on rank 0 looks at the particles of all
  /// ranks at frames. Numbers of reports need no such thing.
  virtual void watch(bool watched) = 0;
  /// How the ranks fare, as of the last frame: an object of numbers, for --stats. Empty without ranks.
  virtual Value ranksReport() const = 0;
};

}  // namespace weir
