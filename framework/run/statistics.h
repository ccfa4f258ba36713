// What is known of a run in numbers: what --stats writes, and the warnings at its end.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "framework/base/api.h"
#include "framework/run/observer.h"

namespace WEIR_API weir {

/// Median, 95th percentile, mean and largest of some durations; all 0 if there are none. A percentile is the
/// least of them that is not below that share of all.
struct TimeSummary {
  double median = 0, p95 = 0, mean = 0, max = 0;
};
TimeSummary summarize(std::span<const double> times);

/// The most memory that this process has held, in bytes.
std::size_t peakHostMemory();

/// Everything about the run so far, as one object:
///   version, scene, title, end, device {name, back_end, description}, deterministic, particles, frames,
///   steps, simulated_seconds, dt (the longest allowed), time_step {shortest, mean, longest}, wall_seconds,
///   setup_seconds, stepping_seconds, step_ms {median, p95, mean, max}, outputs {"pictures":
///   {capture_seconds, wait_seconds, write_seconds}} (see OutputTime), modules_ms {"water/solver": {total,
///   per_step, calls}}, memory {host_peak_bytes, device_estimated_bytes, device_peak_bytes,
///   device_reserved_bytes, device_reserved_peak_bytes, device_in_use_bytes, device_allocations,
///   device_bytes_of_nodes}, blocking_readbacks, nodes {"water": {type, …what the node reports…}},
///   rare_events [{node, what, count}].
/// step_ms and modules_ms are of the steps that this process made: a resumed run knows no times of those
/// before. The node of a rare event of the time steps is "world". A node that cannot report, as the run
/// failed in it, has "error" instead. Waits for the device.
Value runStatistics(Simulation& simulation, RunEnd end);

/// What changes in time, at the frame that was just reached: frame, time [s], steps, particles,
/// stepping_seconds, and nodes and rare_events as above. Waits for the device.
Value frameStatistics(Simulation& simulation);

/// "water: 3 particles left the domain", from the "rare_events" of runStatistics.
std::vector<std::string> rareEventTexts(const Value& statistics);

}  // namespace weir
