#include "framework/run/simulation.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "framework/base/check.h"
#include "framework/base/interruption.h"
#include "framework/compute/host_memory.h"
#include "framework/compute/profiler.h"
#include "framework/graph/state.h"
#include "framework/run/progress.h"

namespace weir {

namespace {

double secondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// Modules are timed in at most one step in kStepsPerDetailed, and not again for a while: a step in which they
// are is launched kernel by kernel, and takes up to 0.1 ms longer.
constexpr std::int64_t kStepsPerDetailed = 32;
constexpr std::chrono::milliseconds kBetweenDetailed{20};

}  // namespace

Clock clockOf(const Scene& scene) {
  const World& world = scene.world;
  const auto clockWith = [&](double dt, const Property& parameter) -> Clock {
    try {
      return {world.frameRate, dt, world.duration};
    } catch (Error& e) {
      e.inParameter(parameter.name());
      throw world.locate(e).at({.file = scene.file, .pointer = "/world"});
    }
  };
  if (world.minDt.get()) clockWith(*world.minDt.get(), world.minDt);  // what it might come to
  return clockWith(world.dt, world.dt);
}

Simulation::Simulation(std::unique_ptr<Scene> scene, Device& device, Log& log, const Registry& registry)
    : scene_(std::move(scene)), device_(device), log_(log), registry_(registry), clock_(clockOf(*scene_)) {}

StepContext Simulation::stepContext() {
  scene_->animate(time());
  return {.device = device_,
          .log = log_,
          .gravity = scene_->world.gravity,
          .time = time(),
          .dt = stepsVary() ? longestStep() : clock_.dtAfterFrame(frame_),
          .index = stepsDone_};
}

double Simulation::longestStep() const {
  const World& world = scene_->world;
  return stepsVary() ? std::min(world.dt.get(), 1 / world.frameRate) : clock_.longestStep();
}

void Simulation::setDuration(double duration) {
  if (!(duration >= time()))
    throw usageError("found a duration of " + Value(duration).brief() + " s",
                     "no less than the " + Value(time()).brief() + " s that are simulated already");
  if (frame_ >= clock_.frameCount() && !atFrame())
    throw usageError(
        "the simulation is behind its last frame, in steps that a longer duration would not have",
        "another duration before that, or one that is a whole number of frames from the start");
  scene_->world.duration.set(duration);
  clock_ = clockOf(*scene_);
}

SetupContext Simulation::setupContext(std::optional<std::int64_t> last, Log& log) {
  scene_->animate(0);
  return {.device = device_,
          .log = log,
          .registry = registry_,
          .gravity = scene_->world.gravity,
          .dt = longestStep(),
          .seed = scene_->world.seed,
          .stepsVary = stepsVary(),
          .end = last ? clock_.frameTime(std::min(*last, clock_.frameCount())) : scene_->world.duration.get(),
          .progress = progress_};
}

MemoryEstimate Simulation::estimate(std::optional<std::int64_t> last) {
  clock_ = clockOf(*scene_);
  return scene_->graph.estimate(setupContext(last, log_));
}

void Simulation::setUp(std::optional<std::int64_t> last, Log& log) {
  clock_ = clockOf(*scene_);
  resetAt_ = WallClock::now();
  frame_ = stepInFrame_ = stepsDone_ = 0;
  time_ = 0;
  lengths_ = {};
  const SetupContext context = setupContext(last, log);
  checkMemory(context);
  scene_->graph.reset(context);
}

void Simulation::checkMemory(const SetupContext& context) {
  const MemoryEstimate estimate = scene_->graph.estimate(context);
  memoryNeeds_ = estimate.total();
  const auto available = static_cast<double>(device_.availableMemory());
  const std::string warning = estimate.check(available, device_.name());
  if (!warning.empty()) context.log.warn(warning);
  if (memoryNeeds_.particles > 0)
    context.log.info("memory: up to " + shortBytes(memoryNeeds_.device) +
                     (available > 0 ? " of " + shortBytes(available) : "") + ", for up to " +
                     groupedText(std::llround(memoryNeeds_.particles)) + " particles");
  if (device_.kind() != DeviceKind::kCpu) estimate.checkHost(static_cast<double>(availableHostMemory()));
}

void Simulation::reset(std::optional<std::int64_t> last) {
  const InterruptibleWork work;
  setUp(last, log_);
  fresh_ = false;
  refresh();
  device_.synchronize();
  device_.profiler().clear();  // what is profiled are the steps
  setupSeconds_ = secondsSinceReset();
  stepSeconds_ = 0;
}

void Simulation::save(const StateWriter& to) const {
  WEIR_CHECK(atFrame());
  const StateWriter clock = to.in("clock");
  clock.put("frame", frame_);
  clock.put("steps", stepsDone_);
  clock.put("time", time_);
  clock.put("step_lengths", lengths_);
  clock.put("step_seconds", stepSeconds_);
  clock.put("wall_seconds", secondsSinceReset());
  scene_->graph.save(to.in("nodes"));
}

void Simulation::resume(const StateReader& from, std::optional<std::int64_t> last) {
  const InterruptibleWork work;
  setUp(last, log_);
  const StateReader clock = from.in("clock");
  clock.get("frame", frame_);
  clock.get("steps", stepsDone_);
  clock.get("time", time_);
  clock.get("step_lengths", lengths_);
  scene_->animate(time());
  scene_->graph.restore(from.in("nodes").on(device_));
  fresh_ = true;  // as it was at the frame
  device_.synchronize();
  device_.profiler().clear();
  setupSeconds_ = secondsSinceReset();
  clock.get("step_seconds", stepSeconds_);
  double before = 0;
  clock.get("wall_seconds", before);
  resetAt_ -= std::chrono::duration_cast<WallClock::duration>(std::chrono::duration<double>(before));
}

void Simulation::replay() {
  Log silent;  // nodes have said what they have to say when the run was recorded
  setUp(0, silent);
  fresh_ = true;
  showAt(0, 0);
  device_.synchronize();
}

void Simulation::showAt(std::int64_t frame, double time) {
  frame_ = frame;
  shownTime_ = time;
  scene_->animate(time);
}

void Simulation::follow(const std::vector<Node*>& nodes, double before) {
  WEIR_CHECK(isReplay());
  StepContext context = stepContext();
  context.time = before;
  context.dt = time() - before;
  scene_->graph.follow(nodes, context);
}

bool Simulation::stepIsLeft() const {
  return stepsVary() ? time_ < clock_.endAfterFrame(frame_) : stepInFrame_ < clock_.stepsAfterFrame(frame_);
}

double Simulation::chooseStep(const StepContext& next) {
  const ProfileScope scope(device_.profiler(), "time step");
  const World& world = scene_->world;
  const double wanted = scene_->graph.longestStep(next, *world.cfl.get());
  double longest = std::min(next.dt, wanted);
  if (!(longest >= world.shortestStep())) {
    lengths_.minWanted = lengths_.tooLong == 0 ? wanted : std::min(lengths_.minWanted, wanted);
    ++lengths_.tooLong;
    longest = world.shortestStep();
  }
  return evenStep(clock_.endAfterFrame(frame_) - time_, longest);
}

double Simulation::untilFrameAfter(double dt) const {
  if (stepsVary()) return std::max(0.0, clock_.endAfterFrame(frame_) - time_ - dt);
  return static_cast<double>(clock_.stepsAfterFrame(frame_) - stepInFrame_ - 1) * dt;
}

void Simulation::passStep(double dt) {
  lengths_.shortest = stepsDone_ == 0 ? dt : std::min(lengths_.shortest, dt);
  lengths_.longest = std::max(lengths_.longest, dt);
  const double end = clock_.endAfterFrame(frame_);
  time_ = end - time_ <= dt ? end : time_ + dt;
  ++stepInFrame_;
  ++stepsDone_;
}

bool Simulation::timesModules(WallClock::time_point start) {
  // The first step is like no other, and may do much that comes once.
  const bool now = stepsDone_ == 1 || timesModulesNext_ ||
                   (++stepsUntimed_ >= kStepsPerDetailed && start - modulesTimedAt_ >= kBetweenDetailed);
  if (now) timesModulesNext_ = false, stepsUntimed_ = 0, modulesTimedAt_ = start;
  return now;
}

void Simulation::step() {
  WEIR_CHECK(stepIsLeft());
  fresh_ = false;
  const WallClock::time_point start = WallClock::now();
  Profiler& profiler = device_.profiler();
  const bool detailed = profiler.timesKernels() || timesModules(start);
  profiler.beginStep(detailed);
  StepContext context = stepContext();
  if (stepsVary()) context.dt = chooseStep(context);
  context.untilFrame = untilFrameAfter(context.dt);
  std::optional<LaunchBatch> batch;
  if (!detailed && stepsDone_ > 0) batch.emplace(device_);
  scene_->graph.step(context);
  if (batch) batch->end();
  profiler.endStep();
  profiler.poll();
  passStep(context.dt);
  stepSeconds_ += secondsSince(start);
}

bool Simulation::finishSteps(const std::atomic<bool>& stop, const std::function<void()>& afterStep) {
  while (stepIsLeft()) {
    if (stop) return false;
    step();
    if (afterStep) afterStep();
  }
  return true;
}

bool Simulation::advanceFrame(const std::atomic<bool>& stop, const std::function<void()>& afterStep) {
  if (frame_ >= clock_.frameCount() || !finishSteps(stop, afterStep)) return false;
  ++frame_;
  stepInFrame_ = 0;
  refresh();
  return true;
}

bool Simulation::finishRest(const std::atomic<bool>& stop, const std::function<void()>& afterStep) {
  if (!finishSteps(stop, afterStep)) return false;
  refresh();
  return true;
}

void Simulation::refresh() {
  if (fresh_) return;
  const WallClock::time_point start = WallClock::now();
  scene_->graph.frame(stepContext());  // waits for the steps so far, where they run beside the host
  fresh_ = true;
  stepSeconds_ += secondsSince(start);
}

std::int64_t Simulation::particleCount() const {
  std::int64_t count = 0;
  for (const auto& node : scene_->graph.nodes()) count += node->particleCount();
  return count;
}

double Simulation::secondsSinceReset() const {
  return secondsSince(resetAt_);
}

}  // namespace weir
