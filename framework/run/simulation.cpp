#include "framework/run/simulation.h"

#include "framework/base/check.h"

namespace weir {

Clock clockOf(const Scene& scene) {
  try {
    return {scene.world.frameRate, scene.world.dt, scene.world.duration};
  } catch (Error& e) {
    throw e.at({.file = scene.file, .pointer = "/world"});
  }
}

Simulation::Simulation(std::unique_ptr<Scene> scene, Device& device, Log& log, const Registry& registry)
    : scene_(std::move(scene)), device_(device), log_(log), registry_(registry), clock_(clockOf(*scene_)) {}

StepContext Simulation::stepContext() const {
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
}

void Simulation::step() {
  WEIR_CHECK(stepInFrame_ < clock_.stepsAfterFrame(frame_));
  fresh_ = false;
  Profiler& profiler = device_.profiler();
  profiler.beginStep();
  scene_->graph.step(stepContext());
  profiler.endStep();
  profiler.poll();
  ++stepInFrame_;
  ++stepsDone_;
}

bool Simulation::stepUntil(std::int64_t steps, const std::atomic<bool>& stop) {
  while (stepInFrame_ < steps) {
    if (stop) return false;
    step();
  }
  return true;
}

bool Simulation::advanceFrame(const std::atomic<bool>& stop) {
  if (frame_ >= clock_.frameCount() || !stepUntil(clock_.stepsAfterFrame(frame_), stop)) return false;
  ++frame_;
  stepInFrame_ = 0;
  refresh();
  return true;
}

bool Simulation::finishRest(const std::atomic<bool>& stop) {
  if (!stepUntil(clock_.stepsAfterFrame(frame_), stop)) return false;
  refresh();
  return true;
}

void Simulation::refresh() {
  if (fresh_) return;
  scene_->graph.frame(stepContext());
  fresh_ = true;
}

std::int64_t Simulation::particleCount() const {
  std::int64_t count = 0;
  for (const auto& node : scene_->graph.nodes()) count += node->particleCount();
  return count;
}

double Simulation::secondsSinceReset() const {
  return std::chrono::duration<double>(WallClock::now() - resetAt_).count();
}

}  // namespace weir
