// A scene in time, on one device.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "framework/base/api.h"
#include "framework/run/clock.h"
#include "framework/scene/scene.h"

namespace WEIR_API weir {

/// The clock that a scene's "world" asks for. Throws a scene Error that names the file for what no clock can
/// do; checking a scene therefore means to make its clock, too.
Clock clockOf(const Scene& scene);

/// A part of an observer's work.
struct OutputPart {
  std::string name;
  double seconds = 0;
};

/// What an observer of a run cost, in seconds of wall clock.
struct OutputTime {
  std::string name;
  double capture = 0;             ///< that the simulation waited while frames were copied
  double wait = 0;                ///< that it waited because frames came faster than they could be written
  double write = 0;               ///< in which frames were written beside it
  std::vector<OutputPart> parts;  ///< of `write`
};

/// Runs one scene on one device. Two of them in one process do not know of each other. Device, log, registry
/// and the plugins that the scene uses must outlive it.
class Simulation {
 public:
  Simulation(std::unique_ptr<Scene> scene, Device& device, Log& log, const Registry& registry);

  Scene& scene() { return *scene_; }
  const Scene& scene() const { return *scene_; }
  Device& device() const { return device_; }
  Log& log() const { return log_; }
  const Registry& registry() const { return registry_; }
  const Clock& clock() const { return clock_; }

  /// Gives the scene away, with all that its nodes hold on the device; only destruction may follow.
  std::unique_ptr<Scene> release() { return std::move(scene_); }
  /// The run ends at this time, s, from now on, not before what was simulated already. Throws as clockOf.
  void setDuration(double duration);

  /// To time 0, frame 0, with the world's frame rate, step and duration as they are now. `last` is the frame
  /// at which the run will end, if its duration does not end it before. Throws a scene Error if what the
  /// scene needs until then does not fit into memory (memory_estimate.h).
  void reset(std::optional<std::int64_t> last = {});
  /// What a reset would estimate; makes nothing, and throws nothing for want of memory.
  MemoryEstimate estimate(std::optional<std::int64_t> last = {});
  /// The part of a reset in which nodes check their settings and put particles in place; not that of frame 0,
  /// in which fluids come to rest. Only a reset may follow.
  void prepare(std::optional<std::int64_t> last = {}) { setUp(last, log_); }
  /// Is told of each node that is set up, see SetupContext.
  void onSetUp(decltype(SetupContext::progress) progress) { progress_ = std::move(progress); }
  /// What the last reset estimated.
  const MemoryNeeds& memoryNeeds() const { return memoryNeeds_; }
  /// All that the future depends on; to be called at a frame.
  void save(const StateWriter& to) const;
  /// In place of a reset: to the frame at which the same scene was saved.
  void resume(const StateReader& from, std::optional<std::int64_t> last = {});
  /// In place of a reset, for a run that was recorded: all nodes are there, but nothing is brought to rest
  /// and nothing will move. Frames are shown by showAt().
  void replay();
  bool isReplay() const { return shownTime_.has_value(); }
  /// Of a replay: the frame and its time in s, for whoever looks. What the fluids hold is the caller's
  /// affair.
  void showAt(std::int64_t frame, double time);
  /// Of a replay: these nodes go on by a step, from `before`, in s, to the frame that is shown.
  void follow(const std::vector<Node*>& nodes, double before);
  void step();  ///< one step; there must be one left
  /// In the next step modules are timed, as they are now and then.
  void timeModulesNext() { timesModulesNext_ = true; }
  /// Steps to the next frame. False if there is none, or if `stop` was set before it was reached; then it
  /// goes on from there when it is called again. `afterStep` is called after each step, if it is given.
  bool advanceFrame(const std::atomic<bool>& stop, const std::function<void()>& afterStep = {});
  /// Steps through what is left after the last frame. False if `stop` was set before that was done.
  bool finishRest(const std::atomic<bool>& stop, const std::function<void()>& afterStep = {});

  /// Whether the length of steps follows the motion ("cfl" in the scene's world), so that nobody knows how
  /// many there will be.
  bool stepsVary() const { return scene_->world.cfl.get().has_value(); }
  /// The longest step that it may make, s.
  double longestStep() const;

  std::int64_t frame() const { return frame_; }  ///< the last frame that was reached
  std::int64_t stepsDone() const { return stepsDone_; }
  double time() const {
    if (shownTime_) return *shownTime_;
    return stepsVary() ? time_ : clock_.stepTime(frame_, stepInFrame_);
  }
  bool atFrame() const { return stepInFrame_ == 0; }  ///< exactly at a frame time
  std::int64_t particleCount() const;

  /// Brings what nodes show and report up to date with the last step, as it always is at a frame.
  void refresh();

  /// Of the steps so far.
  struct StepLengths {
    double shortest = 0, longest = 0;  ///< s
    /// Where world.min_dt kept a step from being as short as the nodes asked, and the least that one asked.
    std::int64_t tooLong = 0;
    double minWanted = 0;  ///< s
  };
  const StepLengths& stepLengths() const { return lengths_; }

  // Wall-clock times, in seconds.
  double setupSeconds() const { return setupSeconds_; }  ///< that the last reset took
  double secondsSinceReset() const;                      ///< since the last reset began
  double stepSeconds() const { return stepSeconds_; }    ///< in steps since then, without observers
  /// Of all observers; runSimulation tells it when all frames are written.
  const std::vector<OutputTime>& outputTimes() const { return outputTimes_; }
  void setOutputTimes(std::vector<OutputTime> times) { outputTimes_ = std::move(times); }

 private:
  using WallClock = std::chrono::steady_clock;

  /// Makes all nodes anew, if there is memory for them.
  void setUp(std::optional<std::int64_t> last, Log& log);
  SetupContext setupContext(std::optional<std::int64_t> last, Log& log);
  void checkMemory(const SetupContext& context);
  /// The context of what comes next, with the world as it is then.
  StepContext stepContext();
  bool stepIsLeft() const;
  /// The length of the next step, where that follows the motion.
  double chooseStep(const StepContext& next);
  double untilFrameAfter(double dt) const;
  void passStep(double dt);
  /// Whether modules are timed in a step that begins at `start`.
  bool timesModules(WallClock::time_point start);
  bool finishSteps(const std::atomic<bool>& stop, const std::function<void()>& afterStep);

  std::unique_ptr<Scene> scene_;
  Device& device_;
  Log& log_;
  const Registry& registry_;
  Clock clock_;
  std::int64_t frame_ = 0, stepInFrame_ = 0, stepsDone_ = 0;
  double time_ = 0;                  // where steps vary
  std::optional<double> shownTime_;  // of a replay
  StepLengths lengths_;
  MemoryNeeds memoryNeeds_;
  bool fresh_ = false;  // whether the nodes' frame hooks have seen the last step
  WallClock::time_point resetAt_ = WallClock::now();
  double setupSeconds_ = 0, stepSeconds_ = 0;
  bool timesModulesNext_ = false;
  std::int64_t stepsUntimed_ = 0;  // since modules were timed
  WallClock::time_point modulesTimedAt_;
  std::vector<OutputTime> outputTimes_;
  decltype(SetupContext::progress) progress_;
};

}  // namespace weir
