// The role of nodes that make initial particles such that no rank has all of them.
//
// Where ranks share the particles, each makes a part, whichever is quickly made: it says nothing of where
// these are. The fluid sends them to the ranks that they belong to (initial_division.h), with the ids that
// they would have had on one.
#pragma once

#include <cstdint>
#include <vector>

#include "framework/base/api.h"
#include "framework/graph/node.h"
#include "framework/graph/port.h"

namespace WEIR_API weir {

/// What a rank has made of a batch, which then has these particles alone, with one velocity and no
/// attributes.
struct BatchPart {
  /// Particles of the batch from `first` on, which are those from `number` on of all ranks together.
  struct Run {
    std::int64_t first = 0, number = 0, count = 0;
  };

  std::int64_t all = 0;   ///< particles of all ranks
  std::vector<Run> runs;  ///< in the order of the batch, which is that of all
};

class MadeByRanks {
 public:
  virtual ~MadeByRanks() = default;
  /// As of the last reset; null where every rank makes all, which is known before.
  virtual BatchPart* part() = 0;
  /// Whether its batch will have a container.
  virtual bool rests() const = 0;
};

/// That of the node above a link; null if every rank has all that it puts out.
inline BatchPart* partOf(const OutputPort& source) {
  auto* const maker = dynamic_cast<MadeByRanks*>(&source.node());
  return maker != nullptr ? maker->part() : nullptr;
}

}  // namespace weir
