#include "framework/run/run.h"

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "framework/run/output_worker.h"

namespace weir {

std::string_view nameOf(RunEnd end) {
  switch (end) {
    case RunEnd::kFinished:
      return "finished";
    case RunEnd::kInterrupted:
      return "interrupted";
    case RunEnd::kFailed:
      return "failed";
  }
  return "failed";
}

std::int64_t lastFrameOf(const Clock& clock, const RunOptions& options) {
  return std::min(clock.frameCount(), options.lastFrame.value_or(clock.frameCount()));
}

namespace {

/// Observers that have begun, each with its thread, and the first error of all.
class Outputs {
 public:
  void add(Observer& observer) { workers_.push_back(std::make_unique<OutputWorker>(observer, errors)); }

  void showFrame(Simulation& simulation) {
    for (const auto& worker : workers_) worker->frame(simulation);
    errors.rethrowIfAny();
  }
  /// Waits until all frames are written; from then on there are no threads.
  void finish(Simulation& simulation) {
    std::vector<OutputTime> times;
    for (const auto& worker : workers_) {
      worker->finish();
      times.push_back(worker->time());
    }
    simulation.setOutputTimes(std::move(times));
  }
  void end(Simulation& simulation, RunEnd how) {
    for (const auto& worker : workers_) {
      try {
        worker->observer().end(simulation, how);
      } catch (...) {
        errors.keepCurrent();
      }
    }
  }

  FirstError errors;

 private:
  std::vector<std::unique_ptr<OutputWorker>> workers_;
};

RunEnd runFrames(Simulation& simulation, Outputs& outputs, const RunOptions& options) {
  const std::atomic<bool> never = false;
  const std::atomic<bool>& stop = options.stop != nullptr ? *options.stop : never;
  const std::int64_t last = lastFrameOf(simulation.clock(), options);
  const auto showProgress = [&] {
    if (options.onProgress) options.onProgress(simulation);
  };
  const auto afterStep = [&] {
    outputs.errors.rethrowIfAny();
    showProgress();
  };
  simulation.reset();
  outputs.showFrame(simulation);
  showProgress();
  while (simulation.frame() < last) {
    if (!simulation.advanceFrame(stop, afterStep)) return RunEnd::kInterrupted;
    outputs.showFrame(simulation);
    showProgress();
  }
  const bool whole = last == simulation.clock().frameCount();
  if (whole && !simulation.finishRest(stop, afterStep)) return RunEnd::kInterrupted;
  return RunEnd::kFinished;
}

}  // namespace

RunEnd runSimulation(Simulation& simulation, std::span<Observer* const> observers,
                     const RunOptions& options) {
  Outputs outputs;
  RunEnd end = RunEnd::kFailed;
  try {
    for (Observer* observer : observers) {
      observer->begin(simulation);
      outputs.add(*observer);
    }
    end = runFrames(simulation, outputs, options);
  } catch (...) {
    outputs.errors.keepCurrent();
  }
  outputs.finish(simulation);
  if (outputs.errors.any()) end = RunEnd::kFailed;
  outputs.end(simulation, end);
  outputs.errors.rethrowIfAny();
  return end;
}

}  // namespace weir
