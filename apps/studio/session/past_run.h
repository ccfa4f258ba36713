// A run as it was at one of its frames, in a simulation of its own beside it: for those who look back.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "apps/studio/session/recording.h"
#include "framework/run/simulation.h"

namespace weir::studio {

/// Belongs to the thread of the run. Takes as much memory as the run once somebody has looked back, on a
/// device of its own, as the run's keeps the times of the run's steps.
class PastRun {
 public:
  /// `changing` is called before the simulation shows another frame, `leaving` before it goes. The registry
  /// must outlive this.
  PastRun(const Registry& registry, int threads, std::function<void()> changing,
          std::function<void()> leaving);
  ~PastRun() { forget(); }
  PastRun(const PastRun&) = delete;
  PastRun& operator=(const PastRun&) = delete;

  /// Another run: its scene once more, null for none, and the name of its device. Nothing is built yet.
  void begin(std::unique_ptr<Scene> scene, std::string device);
  /// The run as it was at the frame of one of its states, as a replay (Simulation::replay). Throws a usage
  /// Error with the reason, such as too little memory, if it cannot be built beside the run.
  Simulation& at(const RunState& state);

 private:
  /// Gives back all memory.
  void forget();
  void build(const RunState& state);

  const Registry& registry_;
  const int threads_;
  const std::function<void()> changing_, leaving_;
  Log silent_;  // nodes have said what they have to say
  std::unique_ptr<Scene> scene_;
  std::string deviceName_;
  std::unique_ptr<Device> device_;
  std::unique_ptr<Simulation> simulation_;
  bool isSetUp_ = false;
  RunState shown_;
};

}  // namespace weir::studio
