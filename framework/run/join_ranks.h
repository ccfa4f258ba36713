// A simulation as one of several ranks that share a run.
#pragma once

#include <atomic>

#include "framework/base/api.h"
#include "framework/communication/communicator.h"
#include "framework/run/run.h"

namespace WEIR_API weir {

/// Before the reset, on every rank with the same scene. Throws a scene Error that names the node if one of
/// them cannot run on several ranks. `watched` is rank 0's: whether something there looks at the particles of
/// all at every frame.
void joinRanks(Simulation& simulation, Communicator& ranks, bool watched = true);

/// While it lives, the run with these options ends on all ranks at the same step once `asked` is true on one,
/// or one has saved and stops, and all make a checkpoint where it is due on rank 0.
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
