// What a sweep keeps of one of its points, in the point's folder:
//
//   point.json       what the point is a run of
//   stats.json       --stats of its run
//   error.json       why the last run of it failed
//   log.txt          what the last run of it said
//   checkpoint.h5    while it is not finished
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "apps/weir/sweep/points.h"
#include "framework/base/value.h"

namespace weir::app {

enum class PointState { kOpen, kDone, kFailed };

/// "open", "done", "failed"
std::string_view nameOf(PointState state);

/// How a run failed.
struct PointError {
  int code = 0;  ///< the exit code of the program
  std::string text;
};

class PointFolder {
 public:
  explicit PointFolder(std::filesystem::path folder) : folder_(std::move(folder)) {}

  const std::filesystem::path& path() const { return folder_; }
  std::filesystem::path stats() const { return folder_ / "stats.json"; }
  std::filesystem::path log() const { return folder_ / "log.txt"; }
  std::filesystem::path checkpoint() const { return folder_ / "checkpoint.h5"; }

  PointState state() const;
  /// The statistics of a finished run, an object; none if there are no whole ones.
  std::optional<Value> statistics() const;
  std::optional<PointError> error() const;

  /// Throws an io Error if the folder holds results of another run than `identity` says.
  void checkIdentity(const Value& identity) const;

  // All that follows throws an io Error if it cannot be done.

  /// Makes the folder and says what it is of. What is known of a failure is forgotten.
  void begin(const Value& identity) const;
  void keepError(const PointError& error) const;
  /// After a run that is finished: removes its checkpoints.
  void finish() const;

 private:
  std::filesystem::path identityFile() const { return folder_ / "point.json"; }
  std::filesystem::path errorFile() const { return folder_ / "error.json"; }

  std::filesystem::path folder_;
};

/// What decides the results of a point: the version of the program, the scene with what it includes, options
/// of the run, the point, and all files that the scene or the point name. Throws an Error if the scene cannot
/// be read.
class SweepIdentity {
 public:
  SweepIdentity(const std::filesystem::path& scene, const std::vector<std::string>& options);

  Value of(const Point& point) const;

 private:
  Value shared_;
  std::filesystem::path sceneFolder_;
};

}  // namespace weir::app
