// The frame loop: runs a simulation from time 0 to its end, and shows every frame to the observers.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>

#include "framework/base/api.h"
#include "framework/run/checkpoint.h"
#include "framework/run/checkpoints_by_ranks.h"
#include "framework/run/observer.h"

namespace WEIR_API weir {

struct RunOptions {
  /// Ends the run at this frame, if its duration does not end it before. 0 makes frame 0 alone.
  std::optional<std::int64_t> lastFrame;
  /// Looked at between steps. May be set by a signal handler or another thread; null: never set.
  const std::atomic<bool>* stop = nullptr;
  /// Looked at at each frame: a checkpoint is made at the next one, and the run ends there as interrupted.
  /// Null: never set. Only with checkpoints.
  const std::atomic<bool>* saveAndStop = nullptr;
  /// Null: no checkpoints are made. The outputs write all that they captured before one is written.
  Checkpoints* checkpoints = nullptr;
  /// The same in place of those on each of several ranks, with an AgreedRun.
  CheckpointsByRanks* checkpointsByRanks = nullptr;
  /// The state to go on from, in place of a reset; null: none. The observers that have a state there resume.
  /// It is empty once all have it, as it may be large.
  StateArrays* resume = nullptr;
  /// Goes on from where the simulation is, a frame, in place of a reset; the observers see that frame first.
  bool proceed = false;
  /// Where frames come from in place of steps: shows the next frame of a replay (Simulation::showAt), or
  /// returns false behind the last one. The simulation must be a replay. Null: the scene is simulated.
  std::function<bool(Simulation&)> nextFrame;
  /// Called at every frame once the observers have captured it, with whether a checkpoint is due; returns
  /// whether one is made, as on all ranks where it is due on one. Null: what is due.
  std::function<bool(bool isDue)> agreeOnCheckpoint;
  /// Called at frame 0, after every step, and after every frame once the observers have captured it.
  std::function<void(const Simulation&)> onProgress;
};

/// The frame at which such a run ends.
std::int64_t lastFrameOf(const Clock& clock, const RunOptions& options);

/// begin() of all observers, reset, frames, end(). Observers write frames beside the simulation, each on a
/// thread of its own; one that is three frames behind makes the simulation wait. An error of one ends the run
/// at the next step. Whatever happens, the other observers write all frames that they have captured, and
/// end() is called for every observer whose begin() succeeded, in the same order; an error in one does not
/// keep the others from it. The first error is thrown again at the end.
RunEnd runSimulation(Simulation& simulation, std::span<Observer* const> observers,
                     const RunOptions& options = {});

}  // namespace weir
