// A scene in time: the clock, the device, and the frame loop.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "framework/scene/scene.h"

namespace weir {

/// Divides simulated time into frames and frames into equal steps. Frame k is at exactly k / frameRate.
class Clock {
 public:
  /// All in seconds or 1/s, positive; duration may be 0.
  Clock(double frameRate, double longestDt, double duration);

  std::int64_t frameCount() const { return frames_; }  ///< frames after frame 0 that lie within the duration
  double frameTime(std::int64_t frame) const;
  /// Steps between frame k and k + 1; the last interval may be a shorter rest that ends with no frame.
  std::int64_t stepsAfterFrame(std::int64_t frame) const;
  double stepTime(std::int64_t frame, std::int64_t step) const;  ///< start of a step
  double dtAfterFrame(std::int64_t frame) const;
  bool hasRest() const { return rest_ > 0; }  ///< whether time is left after the last frame
  std::int64_t totalSteps() const;

 private:
  double frameRate_, longestDt_, duration_;
  std::int64_t frames_ = 0;
  double rest_ = 0;
};

/// Runs one scene on one device. Two of them in one process do not know of each other.
class Simulation {
 public:
  Simulation(std::unique_ptr<Scene> scene, Device& device, Log& log, const Registry& registry);

  Scene& scene() { return *scene_; }
  const Scene& scene() const { return *scene_; }
  Device& device() const { return device_; }
  const Clock& clock() const { return clock_; }

  void reset();  ///< to time 0, frame 0
  void step();   ///< one step
  /// Steps up to the next frame; false if `stop` was set before it was reached or there is none.
  bool advanceFrame(const std::atomic<bool>& stop);
  /// Steps through what is left after the last frame.
  void finishRest(const std::atomic<bool>& stop);

  std::int64_t frame() const { return frame_; }  ///< the last frame that was reached
  std::int64_t stepsDone() const { return stepsDone_; }
  double time() const;
  std::int64_t particleCount() const;
  /// Statistics of all nodes, device, times: what --stats writes.
  Value statistics();
  /// Rare events of all nodes, "water: 3 particles left the domain".
  std::vector<std::string> rareEvents();

 private:
  StepContext stepContext() const;
  void frameHooks();

  std::unique_ptr<Scene> scene_;
  Device& device_;
  Log& log_;
  const Registry& registry_;
  Clock clock_;
  std::int64_t frame_ = 0, stepInFrame_ = 0, stepsDone_ = 0;
};

}  // namespace weir
