// A simulation as Python drives it: steps without the GIL, callbacks with it, signals in between.
#pragma once

#include <nanobind/nanobind.h>

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "framework/run/checkpoint.h"
#include "python/src/pictures.h"
#include "python/src/python_scene.h"

namespace weir::python {

namespace nb = nanobind;

/// What run() was asked for.
struct RunRequest {
  std::optional<double> duration;  ///< from now on, s
  std::map<std::string, std::string> outputs;
  std::string checkpoint;       ///< the file; "" for none
  std::string checkpointEvery;  ///< see CheckpointInterval
  std::string resume;           ///< the checkpoint to go on from, in place of where it is; "" for none
  nb::object callback;  ///< None, or called with `self` after each step; it ends the run by returning True
  nb::object self;
};

class PythonSimulation {
 public:
  PythonSimulation(std::shared_ptr<PythonScene> scene, const std::string& device, int threads,
                   bool deterministic);

  /// To time 0, with all parameters as they are now.
  void reset();
  /// One step. Throws a usage Error at the end of the duration.
  void step();
  /// To the next frame, that many times; false if a callback ended it.
  bool advance(std::int64_t frames, const nb::object& callback, const nb::object& self);
  /// Frames with outputs; false if a callback ended it. After Ctrl-C the outputs hold what there was, and
  /// KeyboardInterrupt is raised.
  bool run(const RunRequest& request);
  void refresh();
  /// Writes a checkpoint, as run() does. Throws a usage Error between two frames.
  void save(const std::string& file);
  /// Goes on from a checkpoint of the same scene.
  void resume(const std::string& file);
  /// A picture of what is there now, which is brought up to date for it as by refresh(): (height, width, 3)
  /// bytes.
  nb::object render(const LivePictureOptions& options);
  void close();
  bool isOpen() const;
  bool atEnd() const;

  double time() const { return simulation().time(); }
  double duration() const { return simulation().scene().world.duration; }
  void setDuration(double seconds);
  std::int64_t frame() const { return simulation().frame(); }
  std::int64_t steps() const { return simulation().stepsDone(); }
  std::string deviceName() const { return simulation().device().name(); }
  std::uintptr_t stream() const;
  nb::object statistics();
  const std::shared_ptr<PythonScene>& scene() const { return scene_; }

 private:
  /// Throws a usage Error if it is closed.
  Simulation& simulation() const;
  /// The same, if it can go on.
  Simulation& ready() const;
  /// What a checkpoint holds that belongs to this simulation.
  Checkpoint checkpointIn(const std::string& option, const std::string& file) const;
  /// The checkpoint that a run goes on from, which the simulation is to be at next.
  Checkpoint resumedBy(const RunRequest& request);
  /// None where none are asked for.
  std::optional<Checkpoints> checkpointsOf(const RunRequest& request) const;
  /// For a duration from now on: the frame at which it ends, up to which the scene's duration reaches then.
  std::int64_t lastFrameFor(double duration);
  /// Runs f without the GIL; what it throws within a step makes the simulation unusable until a reset.
  void stepping(const std::function<void()>& f);
  /// Takes the GIL; true if the callback ends the run.
  bool callBack(const nb::object& callback, const nb::object& self);

  std::shared_ptr<PythonScene> scene_;
  std::uint64_t number_ = 0;
  bool failed_ = false;  // within a step
  bool inCallback_ = false;
  std::unique_ptr<Pictures> pictures_;  // from the first picture since the reset on
};

void bindSimulation(nb::module_& m);

}  // namespace weir::python
