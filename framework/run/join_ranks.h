// A simulation as one of several ranks that share a run.
#pragma once

#include <atomic>

#include "framework/base/api.h"
#include "framework/communication/communicator.h"
#include "framework/communication/shared_by_ranks.h"
#include "framework/run/run.h"

namespace WEIR_API weir {

/// Before the reset, on every rank with the same scene. Throws a scene Error that names the node if one of
/// them cannot run on several ranks. `watched` is rank 0's.
void joinRanks(Simulation& simulation, Communicator& ranks, WatchedByRanks watched = {});

/// While it lives, the run with these options ends on all ranks at the same step once `asked` is true on one,
/// or one has saved and stops, and ranks gather their particles where rank 0 makes a checkpoint.
class AgreedRun {
 public:
  AgreedRun(Communicator& ranks, const std::atomic<bool>& asked, RunOptions& options);
  AgreedRun(const AgreedRun&) = delete;
  AgreedRun& operator=(const AgreedRun&) = delete;

 private:
  std::atomic<bool> stop_{false};
  bool savedToStop_ = false;
};

}  // namespace weir
