// Observers look at a running simulation: they render, export, or print. They are services of the registry,
// so plugins bring them.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "framework/run/simulation.h"

namespace weir {

/// How a run ended.
enum class RunEnd { kFinished, kInterrupted, kFailed };

class Observer {
 public:
  virtual ~Observer() = default;
  /// Before frame 0. Throws an io Error if it cannot do its work, before any time is spent.
  virtual void begin(Simulation& simulation) = 0;
  /// At each frame, frame 0 included.
  virtual void frame(Simulation& simulation) = 0;
  /// After the last frame; files must be complete and readable when it returns. It is called once if begin
  /// succeeded, also when the run failed or was interrupted.
  virtual void end(Simulation& simulation, RunEnd how) = 0;
};

/// Makes observers from command-line options. A plugin registers one per option:
///   registry.addService<OutputKind>("video", [] { return std::make_unique<VideoOutput>(); });
class OutputKind {
 public:
  static constexpr std::string_view kInterface = "OutputKind";
  virtual ~OutputKind() = default;
  virtual std::string option() const = 0;    ///< "--video"
  virtual std::string argument() const = 0;  ///< "FILE.mp4"
  virtual std::string doc() const = 0;
  virtual std::unique_ptr<Observer> create(const std::filesystem::path& path) const = 0;
  /// Other frame outputs that share work with this one (a video and images of the same pictures) get merged
  /// by their plugin: all paths given for options of the same non-empty group go to one observer.
};

}  // namespace weir
