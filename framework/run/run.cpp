#include "framework/run/run.h"

#include <algorithm>
#include <exception>
#include <vector>

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

void showFrame(Simulation& simulation, const std::vector<Observer*>& observers, const RunOptions& options) {
  for (Observer* observer : observers) observer->frame(simulation);
  if (options.checkpoints != nullptr && options.checkpoints->isDue(simulation))
    options.checkpoints->write(simulation, observers);
  if (options.onProgress) options.onProgress(simulation);
}

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

RunEnd runFrames(Simulation& simulation, const std::vector<Observer*>& observers, const RunOptions& options) {
  const std::atomic<bool> never = false;
  const std::atomic<bool>& stop = options.stop != nullptr ? *options.stop : never;
  const std::int64_t last = lastFrameOf(simulation.clock(), options);
  const auto afterStep = [&] {
    if (options.onProgress) options.onProgress(simulation);
  };
  if (options.resume != nullptr) {
    simulation.resume(StateReader(*options.resume), options.lastFrame);
    if (options.onProgress) options.onProgress(simulation);
  } else {
    simulation.reset(options.lastFrame);
    showFrame(simulation, observers, options);
  }
  while (simulation.frame() < last) {
    if (!simulation.advanceFrame(stop, afterStep)) return RunEnd::kInterrupted;
    showFrame(simulation, observers, options);
  }
  const bool whole = last == simulation.clock().frameCount();
  if (whole && !simulation.finishRest(stop, afterStep)) return RunEnd::kInterrupted;
  return RunEnd::kFinished;
}

}  // namespace

RunEnd runSimulation(Simulation& simulation, std::span<Observer* const> observers,
                     const RunOptions& options) {
  std::vector<Observer*> begun;
  std::exception_ptr error;
  RunEnd end = RunEnd::kFailed;
  try {
    for (Observer* observer : observers) {
      begin(*observer, simulation, options.resume);
      begun.push_back(observer);
    }
    if (options.checkpoints != nullptr) options.checkpoints->begin();
    end = runFrames(simulation, begun, options);
  } catch (...) {
    error = std::current_exception();
  }
  for (Observer* observer : begun) {
    try {
      observer->end(simulation, end);
    } catch (...) {
      if (!error) error = std::current_exception();
    }
  }
  if (error) std::rethrow_exception(error);
  return end;
}

}  // namespace weir
