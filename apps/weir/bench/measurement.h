// Times the steps of one simulation at its beginning and in developed flow, as the clock on the wall has
// them.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "framework/run/simulation.h"

namespace weir::app {

struct MeasurementPlan {
  bool early = true;
  double lateAfter = 1;   ///< simulated time before the second moment, s
  bool isClosed = false;  ///< a particle more or less than at the start means that the run diverged
};

/// A mean compression above this is not a liquid any more, and means that the run diverged.
inline constexpr double kMaxMeanCompression = 0.5;

/// What the steps around one moment took.
struct Moment {
  std::string name;             ///< "early" or "late"
  double from = 0, to = 0;      ///< simulated, s
  std::int64_t particles = 0;   ///< at the end
  std::int64_t timedSteps = 0;  ///< one by one: a step, then a wait for the device
  double medianMs = 0, p95Ms = 0;
  std::int64_t batchedSteps = 0;  ///< without a wait between them but at frames
  double batchMeanMs = 0;
  /// Scopes of the profiler by path, "water/solver", and ms a step.
  std::vector<std::pair<std::string, double>> modulesMs;
  double meanNeighbors = 0, meanCompression = 0, maxCompression = 0;
  std::vector<std::string> rareEvents;
  std::string diverged;  ///< why these times are none of a fluid; empty if they are
};

struct Measurement {
  std::vector<Moment> moments;
  std::int64_t maxParticleCount = 0;
  std::int64_t peakBytes = 0;  ///< of the device
  std::string skipped;         ///< why it could not begin, such as too little memory
  std::string failed;          ///< why it broke off
  bool interrupted = false;
};

/// Runs the simulation from its start. `stop` is looked at between steps; `say` is told what comes next.
/// Errors of the simulation are in the result; others are thrown.
Measurement measure(Simulation& simulation, const MeasurementPlan& plan, const std::atomic<bool>& stop,
                    const std::function<void(const std::string&)>& say);

}  // namespace weir::app
