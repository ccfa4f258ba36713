// Observers look at a running simulation: they render, export, or record.
//
// Looking is done in two parts. capture() copies what the observer needs of a frame while the simulation
// waits, and must be quick. write() draws, encodes and writes it on a thread of the observer's own, while the
// simulation goes on.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "framework/base/api.h"
#include "framework/graph/state.h"
#include "framework/run/simulation.h"

namespace WEIR_API weir {

/// How a run ended.
enum class RunEnd { kFinished, kInterrupted, kFailed };

/// "finished", "interrupted" or "failed".
std::string_view nameOf(RunEnd end);

/// Below which path the states of observers stand in a checkpoint.
inline constexpr std::string_view kOutputStates = "outputs";

/// What an observer needs of one frame. It belongs to it alone: nothing in it changes while the simulation
/// goes on. Each observer has a class of its own.
class Snapshot {
 public:
  virtual ~Snapshot() = default;
};

class Observer {
 public:
  virtual ~Observer() = default;
  /// What it is called in --stats.
  virtual std::string name() const = 0;

  /// Before the simulation is reset. Throws an io Error if it cannot do its work, so that no time is spent on
  /// a run whose result is lost; end() is then not called.
  virtual void begin(Simulation& simulation) = 0;
  /// The name under which its state stands in a checkpoint; "" if it has none, and begins anew when a run is
  /// resumed.
  virtual std::string_view stateName() const { return {}; }
  /// After a frame, before a checkpoint is written, when all that was captured has been written: brings it to
  /// the disk, and saves what it needs to go on from here.
  virtual void save(const StateWriter&) {}
  /// In place of begin(): goes on behind what it had at the checkpoint, whatever it wrote after that. `from`
  /// is what it saved; the simulation is not there yet.
  virtual void resume(Simulation&, const StateReader&) {}
  /// At each frame, frame 0 included. Returns null if there is nothing to write. `used` is a snapshot of this
  /// observer's that has been written, so that its memory can be used again, or null.
  virtual std::unique_ptr<Snapshot> capture(Simulation& simulation, std::unique_ptr<Snapshot> used) = 0;
  /// Once for each snapshot, in the order of the frames, on another thread than all else. May use neither the
  /// simulation nor its device. After an error it is not called again.
  virtual void write(Snapshot&) {}
  /// Of the time in write(), what its parts took so far; asked when the last frame has been written.
  virtual std::vector<OutputPart> writeParts() const { return {}; }
  /// After the last frame has been written; files must be complete and readable when it returns. Called once
  /// if begin() or resume() succeeded, also if the run was interrupted, or failed here or elsewhere. There
  /// may have been no frame.
  virtual void end(Simulation& simulation, RunEnd how) = 0;
};

}  // namespace weir
