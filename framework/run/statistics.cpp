#include "framework/run/statistics.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "framework/base/build_info.h"
#include "framework/communication/shared_by_ranks.h"
#include "framework/compute/step_times.h"

namespace weir {

TimeSummary summarize(std::span<const double> times) {
  if (times.empty()) return {};
  std::vector<double> sorted(times.begin(), times.end());
  std::sort(sorted.begin(), sorted.end());
  const auto percentile = [&](double share) {
    const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(sorted.size())));
    return sorted[std::max<std::size_t>(rank, 1) - 1];
  };
  const double sum = std::accumulate(sorted.begin(), sorted.end(), 0.0);
  return {percentile(0.5), percentile(0.95), sum / static_cast<double>(sorted.size()), sorted.back()};
}

std::size_t peakHostMemory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  constexpr std::size_t kKibibyte = 1024;  // Linux counts in these
  return static_cast<std::size_t>(usage.ru_maxrss) * kKibibyte;
}

namespace {

Value integer(std::uint64_t n) {
  return static_cast<std::int64_t>(n);
}

Value deviceValue(const Device& device) {
  Value v = Value::object();
  v["name"] = device.name();
  v["back_end"] = device.kind() == DeviceKind::kCpu ? "cpu" : "cuda";
  v["description"] = device.description();
  return v;
}

Value stepTimes(Profiler& profiler) {
  TimeSummary times = summarize(profiler.stepMs());
  times.mean = stepTimesOf(profiler).mean();
  times.max = stepTimesOf(profiler).max();
  Value v = Value::object();
  v["median"] = times.median;
  v["p95"] = times.p95;
  v["mean"] = times.mean;
  v["max"] = times.max;
  return v;
}

Value stepLengths(const Simulation& simulation) {
  const Simulation::StepLengths& lengths = simulation.stepLengths();
  const auto steps = static_cast<double>(std::max<std::int64_t>(simulation.stepsDone(), 1));
  Value v = Value::object();
  v["shortest"] = lengths.shortest;
  v["mean"] = simulation.time() / steps;
  v["longest"] = lengths.longest;
  return v;
}

Value moduleTimes(Profiler& profiler) {
  const std::vector<ProfileEntry> entries = profiler.entries();
  const std::int64_t steps = stepTimesOf(profiler).count();  // a resumed run has not timed those before it
  Value v = Value::object();
  for (const ProfileEntry& entry : entries) {
    Value& scope = v[entry.path];
    scope["total"] = entry.totalMs;
    scope["per_step"] = steps > 0 ? entry.totalMs / static_cast<double>(steps) : 0.0;
    scope["calls"] = integer(entry.calls);
  }
  return v;
}

Value memoryValue(const Simulation& simulation) {
  const MemoryUse use = simulation.device().memoryUse();
  Value v = Value::object();
  v["host_peak_bytes"] = integer(peakHostMemory());
  v["device_estimated_bytes"] = integer(static_cast<std::uint64_t>(simulation.memoryNeeds().device));
  v["device_peak_bytes"] = integer(use.peak);
  v["device_reserved_bytes"] = integer(use.reserved);
  v["device_reserved_peak_bytes"] = integer(use.peakReserved);
  v["device_in_use_bytes"] = integer(use.inUse);
  v["device_allocations"] = integer(use.allocations);
  Value& nodes = v["device_bytes_of_nodes"] = Value::object();
  const SceneGraph& graph = simulation.scene().graph;
  for (const auto& node : graph.nodes()) nodes[node->name()] = graph.deviceMemoryOf(*node);
  return v;
}

Value outputTimes(const Simulation& simulation) {
  Value v = Value::object();
  for (const OutputTime& time : simulation.outputTimes()) {
    Value& output = v[time.name];
    output["capture_seconds"] = time.capture;
    output["wait_seconds"] = time.wait;
    output["write_seconds"] = time.write;
    for (const OutputPart& part : time.parts) output[part.name + "_seconds"] = part.seconds;
  }
  return v;
}

/// Of each node whose particles ranks share; empty without ranks.
Value ranksValue(const Simulation& simulation) {
  Value v = Value::object();
  for (const auto& node : simulation.scene().graph.nodes()) {
    const auto* const shared = dynamic_cast<const SharedByRanks*>(node.get());
    Value report = shared != nullptr ? shared->ranksReport() : Value::object();
    if (!report.asObject().empty()) v[node->name()] = std::move(report);
  }
  return v;
}

/// Fills "nodes" and "rare_events".
void addReports(Simulation& simulation, Value& statistics) {
  Value nodes = Value::object();
  Value events = Value::array();
  const auto addEvent = [&](std::string_view where, const RareEvent& event) {
    if (event.count == 0) return;
    Value v = Value::object();
    v["node"] = where;
    v["what"] = event.what;
    v["count"] = event.count;
    events.push(std::move(v));
  };
  const Simulation::StepLengths& lengths = simulation.stepLengths();
  addEvent("world",
           {fmt::format("steps were longer than cfl allows, because of min_dt: down to {:.3g} s would "
                        "have been needed",
                        lengths.minWanted),
            lengths.tooLong});
  for (const auto& node : simulation.scene().graph.nodes()) {
    Value& entry = nodes[node->name()];
    entry["type"] = node->info().type;
    NodeReport report;
    try {
      callGuarded(
          node->source(), [&] { return hookText("", "report", node->source()); },
          [&] { node->report(report); });
    } catch (const std::exception& e) {
      entry["error"] = e.what();
      continue;
    }
    for (auto& [name, value] : report.statistics.asObject()) entry[name] = std::move(value);
    for (const RareEvent& event : report.events) addEvent(node->name(), event);
  }
  statistics["nodes"] = std::move(nodes);
  statistics["rare_events"] = std::move(events);
}

}  // namespace

Value runStatistics(Simulation& simulation, RunEnd end) {
  // After a failure the last frame's state is all there is.
  if (end != RunEnd::kFailed) simulation.refresh();
  Device& device = simulation.device();
  Value v = Value::object();
  v["version"] = version();
  v["scene"] = simulation.scene().file;
  v["title"] = simulation.scene().title;
  v["end"] = nameOf(end);
  v["device"] = deviceValue(device);
  v["deterministic"] = device.deterministic();
  v["particles"] = simulation.particleCount();
  v["frames"] = simulation.frame();
  v["steps"] = simulation.stepsDone();
  v["simulated_seconds"] = simulation.time();
  v["dt"] = simulation.longestStep();
  v["time_step"] = stepLengths(simulation);
  v["wall_seconds"] = simulation.secondsSinceReset();
  v["setup_seconds"] = simulation.setupSeconds();
  v["stepping_seconds"] = simulation.stepSeconds();
  v["step_ms"] = stepTimes(device.profiler());
  v["outputs"] = outputTimes(simulation);
  v["modules_ms"] = moduleTimes(device.profiler());
  v["memory"] = memoryValue(simulation);
  if (Value ranks = ranksValue(simulation); !ranks.asObject().empty()) v["ranks"] = std::move(ranks);
  v["blocking_readbacks"] = integer(device.blockingReadbacks());
  addReports(simulation, v);
  return v;
}

Value frameStatistics(Simulation& simulation) {
  Value v = Value::object();
  v["frame"] = simulation.frame();
  v["time"] = simulation.time();
  v["steps"] = simulation.stepsDone();
  v["particles"] = simulation.particleCount();
  v["stepping_seconds"] = simulation.stepSeconds();
  addReports(simulation, v);
  return v;
}

std::vector<std::string> rareEventTexts(const Value& statistics) {
  std::vector<std::string> texts;
  const Value* events = statistics.find("rare_events");
  if (events == nullptr) return texts;
  for (const Value& event : events->asArray())
    texts.push_back(fmt::format("{}: {} {}", event.find("node")->asString(), event.find("count")->asInt(),
                                event.find("what")->asString()));
  return texts;
}

}  // namespace weir
