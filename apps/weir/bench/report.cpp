#include "apps/weir/bench/report.h"

#include <fmt/format.h>

#include "framework/run/progress.h"

namespace weir::app {

namespace {

/// Of the copy bandwidth, by the model of the least bytes; nothing where there is no model.
std::optional<double> shareOfBandwidth(const BenchResult& result, const Moment& moment, double bandwidth) {
  if (!result.benchCase.passes) return {};
  const double bytes =
      minBytesOfStep(*result.benchCase.passes, moment.meanNeighbors) * static_cast<double>(moment.particles);
  return bytes / (1e-3 * moment.medianMs * bandwidth);
}

double bytesPerParticle(const Measurement& measurement) {
  return static_cast<double>(measurement.peakBytes) / static_cast<double>(measurement.maxParticleCount);
}

/// What may make a time mean less than it seems to, below its line.
std::string noteLines(const Moment& moment) {
  std::string text;
  for (const std::string& event : moment.rareEvents) text += "    note: " + event + "\n";
  return text;
}

std::string momentLine(const BenchResult& result, const Moment& moment, double bandwidth) {
  const std::string start =
      fmt::format("{:<14} {:>11}  {:<6}", result.benchCase.name, groupedText(moment.particles), moment.name);
  if (!moment.diverged.empty()) return start + "diverged: " + moment.diverged + "\n";
  const std::optional<double> share = shareOfBandwidth(result, moment, bandwidth);
  return start + fmt::format("{:>9.4f} {:>9.4f} {:>9.4f} {:>7.3f} {:>7.0f} {:>6} {:>6.2f} {:>8.5f}\n",
                             moment.medianMs, moment.p95Ms, moment.batchMeanMs,
                             1e6 * moment.medianMs / static_cast<double>(moment.particles),
                             bytesPerParticle(result.measurement),
                             share ? fmt::format("{:.3f}", *share) : std::string("-"), moment.meanNeighbors,
                             moment.meanCompression);
}

Value momentValue(const BenchResult& result, const Moment& moment, double bandwidth) {
  Value v = Value::object();
  v["moment"] = moment.name;
  v["from"] = moment.from;
  v["to"] = moment.to;
  v["particles"] = moment.particles;
  v["neighbors_mean"] = moment.meanNeighbors;
  v["compression_mean"] = moment.meanCompression;
  v["compression_max"] = moment.maxCompression;
  Value events = Value::array();
  for (const std::string& event : moment.rareEvents) events.push(event);
  v["rare_events"] = std::move(events);
  if (!moment.diverged.empty()) {
    v["diverged"] = moment.diverged;
    return v;
  }
  v["timed_steps"] = moment.timedSteps;
  v["step_ms_median"] = moment.medianMs;
  v["step_ms_p95"] = moment.p95Ms;
  v["batched_steps"] = moment.batchedSteps;
  v["batch_step_ms_mean"] = moment.batchMeanMs;
  if (result.benchCase.passes) {
    v["least_bytes_per_particle"] = minBytesOfStep(*result.benchCase.passes, moment.meanNeighbors);
    v["share_of_copy_bandwidth"] = *shareOfBandwidth(result, moment, bandwidth);
  }
  Value& modules = v["modules_ms"] = Value::object();
  for (const auto& [path, ms] : moment.modulesMs) modules[path] = ms;
  return v;
}

}  // namespace

std::string BenchResult::name() const {
  return size.empty() ? benchCase.name : benchCase.name + " " + size;
}

bool BenchResult::isBad() const {
  if (!measurement.failed.empty()) return true;
  for (const Moment& moment : measurement.moments)
    if (!moment.diverged.empty()) return true;
  return false;
}

std::string tableHead() {
  return fmt::format("{:<14} {:>11}  {:<6}{:>9} {:>9} {:>9} {:>7} {:>7} {:>6} {:>6} {:>8}\n", "case",
                     "particles", "flow", "step ms", "p95 ms", "batch ms", "ns/p", "mem B/p", "copy", "neigh",
                     "compr");
}

std::string tableLines(const BenchResult& result, double bandwidth) {
  std::string text;
  for (const Moment& moment : result.measurement.moments)
    text += momentLine(result, moment, bandwidth) + noteLines(moment);
  const auto complain = [&](std::string_view what, const std::string& why) {
    if (!why.empty())
      text += fmt::format("{:<14} {:>11}  {}: {}\n", result.benchCase.name, result.size, what, why);
  };
  complain("skipped", result.measurement.skipped);
  complain("failed", result.measurement.failed);
  if (result.measurement.interrupted) complain("interrupted", "no more is timed");
  return text;
}

std::string moduleLines(const BenchResult& result) {
  std::string text;
  for (const Moment& moment : result.measurement.moments) {
    if (!moment.diverged.empty()) continue;
    text += fmt::format("  {} {}:", result.name(), moment.name);
    std::string_view between = " ";
    for (const auto& [path, ms] : moment.modulesMs) {
      text += fmt::format("{}{} {:.4f}", between, path, ms);
      between = ", ";
    }
    text += '\n';
  }
  return text;
}

Value resultValue(const BenchResult& result, double bandwidth) {
  const Measurement& measurement = result.measurement;
  Value v = Value::object();
  v["case"] = result.benchCase.name;
  v["about"] = result.benchCase.about;
  v["scene"] = "resources/scenes/" + result.benchCase.scene;
  Value set = Value::array();
  for (const std::string& text : result.set) set.push(text);
  v["set"] = std::move(set);
  if (!result.size.empty()) v["size"] = static_cast<std::int64_t>(std::stoll(result.size));
  if (!measurement.skipped.empty()) v["skipped"] = measurement.skipped;
  if (!measurement.failed.empty()) v["failed"] = measurement.failed;
  if (measurement.interrupted) v["interrupted"] = true;
  if (measurement.moments.empty()) return v;
  Value& memory = v["memory"] = Value::object();
  memory["peak_bytes"] = measurement.peakBytes;
  memory["bytes_per_particle"] = bytesPerParticle(measurement);
  Value& moments = v["moments"] = Value::array();
  for (const Moment& moment : measurement.moments) moments.push(momentValue(result, moment, bandwidth));
  return v;
}

}  // namespace weir::app
