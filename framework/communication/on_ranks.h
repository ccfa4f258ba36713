// The role of nodes and modules that can run on several ranks. All others are refused there.
#pragma once

#include "framework/base/api.h"
#include "framework/communication/communicator.h"

namespace WEIR_API weir {

/// A node without particles does the same on every rank, so having the role is all that it takes.
class OnRanks {
 public:
  virtual ~OnRanks() = default;
  /// Before the first reset. Throws a scene Error for settings that cannot run on several ranks; keeps the
  /// communicator, which outlives the run, where it is needed.
  virtual void join(Communicator&) {}
};

}  // namespace weir
