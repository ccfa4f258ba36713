#include "framework/run/run.h"

#include <algorithm>
#include <memory>
#include <string>
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
  /// Waits until all frames so far are written.
  void wait() {
    for (const auto& worker : workers_) worker->wait();
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

bool hasState(const Observer& observer, const StateArrays& state) {
  const std::string below = std::string(kOutputStates) + "/" + std::string(observer.stateName()) + "/";
  const auto first = state.lower_bound(below);
  return !observer.stateName().empty() && first != state.end() && first->first.starts_with(below);
}

void begin(Observer& observer, Simulation& simulation, const StateArrays* state) {
  if (state != nullptr && hasState(observer, *state))
    observer.resume(simulation, StateReader(*state).in(kOutputStates).in(observer.stateName()));
  else
    observer.begin(simulation);
}

bool isDue(const RunOptions& options, const Simulation& simulation) {
  if (options.checkpointsByRanks != nullptr) return options.checkpointsByRanks->isDue(simulation);
  return options.checkpoints != nullptr && options.checkpoints->isDue(simulation);
}

void write(const RunOptions& options, Simulation& simulation, std::span<Observer* const> observers) {
  if (options.checkpointsByRanks != nullptr)
    options.checkpointsByRanks->write(simulation, observers);
  else
    options.checkpoints->write(simulation, observers);
}

/// The frames of a run, for observers that have begun.
class FrameLoop {
 public:
  FrameLoop(Simulation& simulation, std::span<Observer* const> observers, Outputs& outputs,
            const RunOptions& options)
      : simulation_(simulation), observers_(observers), outputs_(outputs), options_(options) {}

  RunEnd run() {
    if (options_.nextFrame) return showReplay();
    const std::int64_t last = lastFrameOf(simulation_.clock(), options_);
    start();
    const std::atomic<bool> never = false;
    const std::atomic<bool>& stop = options_.stop != nullptr ? *options_.stop : never;
    const auto afterStep = [this] {
      outputs_.errors.rethrowIfAny();
      showProgress();
    };
    while (simulation_.frame() < last) {
      if (savedToStop_ || !simulation_.advanceFrame(stop, afterStep)) return RunEnd::kInterrupted;
      showFrame();
    }
    const bool whole = last == simulation_.clock().frameCount();
    if (whole && !simulation_.finishRest(stop, afterStep)) return RunEnd::kInterrupted;
    return RunEnd::kFinished;
  }

 private:
  RunEnd showReplay() {
    while (options_.nextFrame(simulation_)) {
      if (options_.stop != nullptr && *options_.stop) return RunEnd::kInterrupted;
      showFrame();
    }
    return RunEnd::kFinished;
  }

  void start() {
    if (options_.resume != nullptr) {
      simulation_.resume(StateReader(*options_.resume), options_.lastFrame);
      options_.resume->clear();
      showProgress();
      return;
    }
    if (!options_.proceed) simulation_.reset(options_.lastFrame);
    simulation_.refresh();
    showFrame();
  }

  void showProgress() {
    if (options_.onProgress) options_.onProgress(simulation_);
  }

  void showFrame() {
    outputs_.showFrame(simulation_);
    const bool ends = options_.saveAndStop != nullptr && *options_.saveAndStop;
    const bool due = ends || isDue(options_, simulation_);
    if (options_.agreeOnCheckpoint ? options_.agreeOnCheckpoint(due) : due) {
      outputs_.wait();
      write(options_, simulation_, observers_);
      savedToStop_ = ends;
    }
    showProgress();
  }

  Simulation& simulation_;
  const std::span<Observer* const> observers_;
  Outputs& outputs_;
  const RunOptions& options_;
  bool savedToStop_ = false;
};

}  // namespace

RunEnd runSimulation(Simulation& simulation, std::span<Observer* const> observers,
                     const RunOptions& options) {
  Outputs outputs;
  RunEnd end = RunEnd::kFailed;
  try {
    for (Observer* observer : observers) {
      begin(*observer, simulation, options.resume);
      outputs.add(*observer);
    }
    if (options.checkpoints != nullptr) options.checkpoints->begin(simulation);
    if (options.checkpointsByRanks != nullptr) options.checkpointsByRanks->begin(simulation);
    end = FrameLoop(simulation, observers, outputs, options).run();
    // What is reported is of the last step. Ranks must do that together.
    if (end == RunEnd::kInterrupted) simulation.refresh();
  } catch (...) {
    outputs.errors.keepCurrent();
  }
  outputs.finish(simulation);
  // Outputs that take long leave out what waits when they are asked to end.
  if (end == RunEnd::kFinished && options.stop != nullptr && *options.stop) end = RunEnd::kInterrupted;
  if (outputs.errors.any()) end = RunEnd::kFailed;
  outputs.end(simulation, end);
  outputs.errors.rethrowIfAny();
  return end;
}

}  // namespace weir
