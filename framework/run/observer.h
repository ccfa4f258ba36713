// Observers look at a running simulation: they render, export, or record.
#pragma once

#include <string_view>

#include "framework/graph/state.h"
#include "framework/run/simulation.h"

namespace weir {

/// How a run ended.
enum class RunEnd { kFinished, kInterrupted, kFailed };

/// "finished", "interrupted" or "failed".
std::string_view nameOf(RunEnd end);

/// Below which path the states of observers stand in a checkpoint.
inline constexpr std::string_view kOutputStates = "outputs";

class Observer {
 public:
  virtual ~Observer() = default;
  /// Before the simulation is reset. Throws an io Error if it cannot do its work, so that no time is spent on
  /// a run whose result is lost; end() is then not called.
  virtual void begin(Simulation& simulation) = 0;
  /// The name under which its state stands in a checkpoint; "" if it has none, and begins anew when a run is
  /// resumed.
  virtual std::string_view stateName() const { return {}; }
  /// After a frame, before a checkpoint is written: brings to the disk what it was shown, and saves what it
  /// needs to go on from here.
  virtual void save(const StateWriter&) {}
  /// In place of begin(): goes on behind what it had at the checkpoint, whatever it wrote after that. `from`
  /// is what it saved; the simulation is not there yet.
  virtual void resume(Simulation&, const StateReader&) {}
  /// At each frame, frame 0 included.
  virtual void frame(Simulation& simulation) = 0;
  /// After the last frame; files must be complete and readable when it returns. Called once if begin()
  /// succeeded, also if the run was interrupted, or failed here or elsewhere. There may have been no frame.
  virtual void end(Simulation& simulation, RunEnd how) = 0;
};

}  // namespace weir
