#include "apps/weir/bench/measurement.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <new>

#include "framework/run/statistics.h"

namespace weir::app {

namespace {

// Whole frames are made until there are that many. Modules are timed in the first step, and now and then.
constexpr std::int64_t kWarmSteps = 20;
constexpr std::size_t kTimedSteps = 40;
constexpr std::int64_t kBatchedSteps = 60;

using WallClock = std::chrono::steady_clock;

double msSince(WallClock::time_point start) {
  return std::chrono::duration<double, std::milli>(WallClock::now() - start).count();
}

double numberAt(const Value& statistics, std::initializer_list<const char*> path) {
  const Value* at = &statistics;
  for (const char* key : path)
    if (at != nullptr) at = at->find(key);
  return at != nullptr && at->isNumber() ? at->asDouble() : std::nan("");
}

class Stopwatch {
 public:
  Stopwatch(Simulation& simulation, const std::atomic<bool>& stop) : simulation_(simulation), stop_(stop) {}

  bool warmUp() {
    const std::int64_t before = simulation_.stepsDone();
    while (simulation_.stepsDone() < before + kWarmSteps)
      if (!simulation_.advanceFrame(stop_)) return false;
    return true;
  }

  bool passUntil(double time) {
    const double half = 0.5 * simulation_.longestStep();
    while (simulation_.time() + half < time)
      if (!simulation_.advanceFrame(stop_)) return false;
    return true;
  }

  /// Nothing if it was interrupted.
  std::optional<Moment> time(std::string name) {
    Moment moment;
    moment.name = std::move(name);
    moment.from = simulation_.time();
    Profiler& profiler = simulation_.device().profiler();
    profiler.clear();
    simulation_.timeModulesNext();
    if (!timeSteps(moment) || !timeBatches(moment)) return {};
    moment.to = simulation_.time();
    const auto steps = static_cast<double>(moment.timedSteps + moment.batchedSteps);
    for (const ProfileEntry& entry : profiler.entries())
      if (entry.depth <= 1) moment.modulesMs.emplace_back(entry.path, entry.totalMs / steps);
    return moment;
  }

 private:
  bool timeSteps(Moment& moment) {
    std::vector<double> times;
    while (times.size() < kTimedSteps) {
      simulation_.device().synchronize();
      WallClock::time_point start = WallClock::now();
      const auto afterStep = [&] {
        simulation_.device().synchronize();
        times.push_back(msSince(start));
        start = WallClock::now();
      };
      if (!simulation_.advanceFrame(stop_, afterStep)) return false;
    }
    const TimeSummary summary = summarize(times);
    moment.particles = simulation_.particleCount();
    moment.timedSteps = static_cast<std::int64_t>(times.size());
    moment.medianMs = summary.median;
    moment.p95Ms = summary.p95;
    return true;
  }

  bool timeBatches(Moment& moment) {
    double total = 0;
    while (moment.batchedSteps < kBatchedSteps) {
      const std::int64_t steps = simulation_.clock().stepsAfterFrame(simulation_.frame());
      std::int64_t left = steps;
      simulation_.device().synchronize();
      const WallClock::time_point start = WallClock::now();
      const auto afterStep = [&] {
        if (--left > 0) return;
        simulation_.device().synchronize();
        total += msSince(start);
      };
      if (!simulation_.advanceFrame(stop_, afterStep)) return false;
      moment.batchedSteps += steps;
    }
    moment.batchMeanMs = total / static_cast<double>(moment.batchedSteps);
    return true;
  }

  Simulation& simulation_;
  const std::atomic<bool>& stop_;
};

std::string divergence(const Moment& moment, const Value& statistics, bool isClosed,
                       std::int64_t particlesAtStart) {
  const double lost = numberAt(statistics, {"nodes", "water", "particles_not_finite"});
  if (lost != 0)
    return fmt::format("{:.0f} particles have positions or velocities that are NaN or infinite", lost);
  if (const double gone = numberAt(statistics, {"nodes", "water", "particles_escaped"}); gone != 0)
    return fmt::format("{:.0f} particles left the domain", gone);
  const std::int64_t particles = statistics.find("particles")->asInt();
  if (isClosed && particles != particlesAtStart)
    return fmt::format("{} of {} particles are left", particles, particlesAtStart);
  if (!std::isfinite(numberAt(statistics, {"nodes", "water", "kinetic_energy"})))
    return "the kinetic energy is NaN or infinite";
  if (!(moment.meanCompression <= kMaxMeanCompression))
    return fmt::format("the mean compression is {:.3g}, above the limit of {:.3g}", moment.meanCompression,
                       kMaxMeanCompression);
  return {};
}

void judge(Moment& moment, Simulation& simulation, bool isClosed, std::int64_t particlesAtStart) {
  const Value statistics = runStatistics(simulation, RunEnd::kFinished);
  moment.meanNeighbors = numberAt(statistics, {"nodes", "water", "neighbors", "mean"});
  moment.meanCompression = numberAt(statistics, {"nodes", "water", "compression", "mean"});
  moment.maxCompression = numberAt(statistics, {"nodes", "water", "compression", "max"});
  moment.rareEvents = rareEventTexts(statistics);
  moment.diverged = divergence(moment, statistics, isClosed, particlesAtStart);
}

/// Runs both moments; whether it came to the end.
bool runMoments(Simulation& simulation, const MeasurementPlan& plan, const std::atomic<bool>& stop,
                const std::function<void(const std::string&)>& say, Measurement& result) {
  const std::int64_t particlesAtStart = simulation.particleCount();
  Stopwatch stopwatch(simulation, stop);
  const auto timeMoment = [&](const std::string& name) {
    std::optional<Moment> moment = stopwatch.time(name);
    if (!moment) return false;
    result.peakBytes = static_cast<std::int64_t>(simulation.device().memoryUse().peak);
    judge(*moment, simulation, plan.isClosed, particlesAtStart);
    result.maxParticleCount = std::max(result.maxParticleCount, simulation.particleCount());
    result.moments.push_back(std::move(*moment));
    return result.moments.back().diverged.empty();
  };
  if (plan.early) {
    say("early");
    if (!stopwatch.warmUp() || !timeMoment("early")) return false;
  }
  say(fmt::format("late: {:g} s are simulated first", plan.lateAfter));
  return stopwatch.passUntil(plan.lateAfter) && stopwatch.warmUp() && timeMoment("late");
}

}  // namespace

Measurement measure(Simulation& simulation, const MeasurementPlan& plan, const std::atomic<bool>& stop,
                    const std::function<void(const std::string&)>& say) {
  Measurement result;
  std::string* complaint = &result.skipped;  // a case that cannot start, such as one too large for memory
  try {
    simulation.reset();
    complaint = &result.failed;
    const bool ended = runMoments(simulation, plan, stop, say, result);
    const bool diverged = !result.moments.empty() && !result.moments.back().diverged.empty();
    result.interrupted = !ended && !diverged;
  } catch (const Error& e) {
    const bool begun = complaint == &result.failed;
    if (begun && e.kind() != ErrorKind::kSimulation) throw;
    *complaint = e.message() + (e.allowed().empty() ? "" : "; allowed: " + e.allowed());
  } catch (const std::bad_alloc&) {
    *complaint = "out of memory";
  }
  return result;
}

}  // namespace weir::app
