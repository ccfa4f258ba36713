// A run whose progress is shown on stderr, and which Ctrl-C and the warnings of queues end.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "apps/weir/program.h"
#include "framework/run/progress.h"
#include "framework/run/run.h"

namespace weir::app {

/// What a run ends with that a warning (SIGUSR1) has ended, once its checkpoint was saved: EX_TEMPFAIL of
/// sysexits.h, by which programs ask to be run again later.
inline constexpr int kSavedForLater = 75;

/// The exit code of such a run.
int exitCodeOf(RunEnd end);

/// runSimulation, with `stop`, `saveAndStop` and `onProgress` of the options set: shows what `state` says,
/// unless `quiet`. The caller has an Interruption, made before it locks its outputs.
RunEnd runShown(Program& program, Simulation& simulation,
                const std::vector<std::unique_ptr<Observer>>& observers, RunOptions options, bool quiet,
                const std::function<ProgressState(const Simulation&)>& state);

}  // namespace weir::app
