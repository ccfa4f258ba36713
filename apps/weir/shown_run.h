// A run whose progress is shown on stderr, and which Ctrl-C ends.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "apps/weir/program.h"
#include "framework/run/progress.h"
#include "framework/run/run.h"

namespace weir::app {

/// runSimulation, with `stop` and `onProgress` of the options set: shows what `state` says, unless `quiet`.
RunEnd runShown(Program& program, Simulation& simulation,
                const std::vector<std::unique_ptr<Observer>>& observers, RunOptions options, bool quiet,
                const std::function<ProgressState(const Simulation&)>& state);

}  // namespace weir::app
