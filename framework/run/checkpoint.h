// Checkpoints: a run that ended, or was killed, goes on where it was.
//
// A checkpoint is made at a frame, after all outputs have seen it and have brought what they were shown to
// the disk. It holds the state of the simulation and of the outputs, and what they belong to: the program's
// version and the scene. How it stands in a file is a plugin's business (CheckpointStore).
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "framework/base/api.h"
#include "framework/graph/state.h"
#include "framework/run/observer.h"

namespace WEIR_API weir {

struct Checkpoint {
  std::string version;  ///< of the program
  std::string scene;    ///< what decides the simulation, as JSON text; see checkpointScene
  std::string device;   ///< the back end, "cpu" or "cuda"
  std::string inputs;   ///< the files that the scene reads, as JSON text; see checkpointInputs
  StateArrays state;
};

/// A service: registry.addService<CheckpointStore>("hdf5", …).
class CheckpointStore {
 public:
  static constexpr std::string_view kInterface = "CheckpointStore";
  virtual ~CheckpointStore() = default;

  /// ".h5": what names of its files end in.
  virtual std::string_view extension() const = 0;
  /// Makes the file, which must not exist, and brings it to the disk. Throws an io Error, and leaves nothing
  /// behind then.
  virtual void write(const std::filesystem::path& file, const Checkpoint& checkpoint) const = 0;
  /// Throws an io Error if there is no such file, or it is no whole checkpoint.
  virtual Checkpoint read(const std::filesystem::path& file) const = 0;
};

/// All of a scene that decides how its simulation goes; not its duration, so that a run can be made longer,
/// and not how it is shown.
std::string checkpointScene(const Scene& scene);

/// Size and digest of each file that a parameter of a node or module names, by the parameter. Throws an io
/// Error if one cannot be read.
std::string checkpointInputs(const Scene& scene);

/// Throws an io Error that names the differences if the checkpoint is of another version of the program,
/// another scene or other files than the simulation. Warns if it is of another back end.
void checkBelongs(const Checkpoint& checkpoint, const Simulation& simulation);

/// How often checkpoints are made: every n frames, or at the first frame after n seconds.
struct CheckpointInterval {
  std::optional<std::int64_t> frames;
  std::optional<double> seconds;

  /// From "20" (frames) or "90s" (seconds of the wall clock). Throws a usage Error.
  static CheckpointInterval parse(const std::string& text);
};

/// Writes a checkpoint now and then. What stands at the path is replaced once the new one is whole; it is
/// kept beside it, as "name.previous.h5".
class Checkpoints {
 public:
  Checkpoints(std::filesystem::path file, CheckpointInterval interval,
              std::unique_ptr<CheckpointStore> store);

  /// Throws an io Error if nothing can be written there. Before the run, as it takes the digests of the files
  /// that the scene is about to read.
  void begin(const Simulation& simulation);
  /// After each frame that the observers have seen.
  bool isDue(const Simulation& simulation) const;
  /// At a frame; the observers save what they need to go on from there. Throws an io Error; the checkpoints
  /// that there are stay then.
  void write(Simulation& simulation, std::span<Observer* const> observers);

  // The parts of write(), for checkpoints that have more (checkpoints_by_ranks.h).
  const std::filesystem::path& file() const { return file_; }
  const CheckpointStore& store() const { return *store_; }
  /// All but the state.
  Checkpoint about(const Simulation& simulation) const;
  /// It takes the place of the last one, though its name may not be on the disk yet; returns whether that one
  /// is the one before now. Throws an io Error; there are the checkpoints that there were then.
  bool put(const Checkpoint& checkpoint);

  /// Where the checkpoint before the last one is kept.
  static std::filesystem::path previousOf(const std::filesystem::path& file);

 private:
  std::filesystem::path file_;
  CheckpointInterval interval_;
  std::unique_ptr<CheckpointStore> store_;
  std::string inputs_ = "{}";
  std::chrono::steady_clock::time_point writtenAt_;
};

}  // namespace weir
