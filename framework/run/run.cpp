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
  if (options.onProgress) options.onProgress(simulation);
}

RunEnd runFrames(Simulation& simulation, const std::vector<Observer*>& observers, const RunOptions& options) {
  const std::atomic<bool> never = false;
  const std::atomic<bool>& stop = options.stop != nullptr ? *options.stop : never;
  const std::int64_t last = lastFrameOf(simulation.clock(), options);
  const auto afterStep = [&] {
    if (options.onProgress) options.onProgress(simulation);
  };
  simulation.reset();
  showFrame(simulation, observers, options);
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
      observer->begin(simulation);
      begun.push_back(observer);
    }
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
