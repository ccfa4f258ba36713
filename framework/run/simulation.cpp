#include "framework/run/simulation.h"

#include "framework/base/check.h"

namespace weir {

namespace {

double secondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

Clock clockOf(const Scene& scene) {
  try {
    return {scene.world.frameRate, scene.world.dt, scene.world.duration};
  } catch (Error& e) {
    throw e.at({.file = scene.file, .pointer = "/world"});
  }
}

Simulation::Simulation(std::unique_ptr<Scene> scene, Device& device, Log& log, const Registry& registry)
    : scene_(std::move(scene)), device_(device), log_(log), registry_(registry), clock_(clockOf(*scene_)) {}

StepContext Simulation::stepContext() {
  scene_->animate(time());
  return {.device = device_,
          .log = log_,
          .gravity = scene_->world.gravity,
          .time = time(),
          .dt = clock_.dtAfterFrame(frame_),
          .index = stepsDone_};
}

void Simulation::reset() {
  resetAt_ = WallClock::now();
  frame_ = stepInFrame_ = stepsDone_ = 0;
  scene_->animate(0);
  scene_->graph.reset({.device = device_,
                       .log = log_,
                       .registry = registry_,
                       .gravity = scene_->world.gravity,
                       .dt = clock_.longestStep(),
                       .seed = scene_->world.seed});
  fresh_ = false;
  refresh();
  device_.synchronize();
  device_.profiler().clear();  // what is profiled are the steps
  setupSeconds_ = secondsSinceReset();
  stepSeconds_ = 0;
}

void Simulation::step() {
  WEIR_CHECK(stepInFrame_ < clock_.stepsAfterFrame(frame_));
  fresh_ = false;
  const WallClock::time_point start = WallClock::now();
  Profiler& profiler = device_.profiler();
  profiler.beginStep();
  scene_->graph.step(stepContext());
  profiler.endStep();
  profiler.poll();
  ++stepInFrame_;
  ++stepsDone_;
  stepSeconds_ += secondsSince(start);
}

bool Simulation::finishSteps(const std::atomic<bool>& stop, const std::function<void()>& afterStep) {
  while (stepInFrame_ < clock_.stepsAfterFrame(frame_)) {
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
