// A simulation as one of several ranks that share a run.
#pragma once

#include <atomic>

#include "framework/base/api.h"
#include "framework/communication/communicator.h"
#include "framework/run/run.h"

namespace WEIR_API weir {

/// Before the reset, on every rank with the same scene. Throws a scene Error that names the node if one of
/// them cannot run on several ranks. `watched` says on rank 0 whether its observers or checkpoints need the
/// particles of all ranks (SharedByRanks::watch).
void joinRanks(Simulation& simulation, Communicator& ranks, bool watched = true);

/// While it lives, the run with these options ends on all ranks at the same step once `asked` is true on one.
class AgreedStop {
 public:
  AgreedStop(Communicator& ranks, const std::atomic<bool>& asked, RunOptions& options);
  AgreedStop(const AgreedStop&) = delete;
  AgreedStop& operator=(const AgreedStop&) = delete;

 private:
  std::atomic<bool> stop_{false};
};

}  // namespace weir
