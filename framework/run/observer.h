// Observers look at a running simulation: they render, export, or record.
#pragma once

#include <string_view>

#include "framework/run/simulation.h"

namespace weir {

/// How a run ended.
enum class RunEnd { kFinished, kInterrupted, kFailed };

/// "finished", "interrupted" or "failed".
std::string_view nameOf(RunEnd end);

class Observer {
 public:
  virtual ~Observer() = default;
  /// Before the simulation is reset. Throws an io Error if it cannot do its work, so that no time is spent on
  /// a run whose result is lost; end() is then not called.
  virtual void begin(Simulation& simulation) = 0;
  /// At each frame, frame 0 included.
  virtual void frame(Simulation& simulation) = 0;
  /// After the last frame; files must be complete and readable when it returns. Called once if begin()
  /// succeeded, also if the run was interrupted, or failed here or elsewhere. There may have been no frame.
  virtual void end(Simulation& simulation, RunEnd how) = 0;
};

}  // namespace weir
