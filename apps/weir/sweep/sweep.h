// Runs the points of a sweep, several at once, each as a `weir run` of its own.
#pragma once

#include <chrono>
#include <deque>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "apps/weir/sweep/child_run.h"
#include "apps/weir/sweep/point_folder.h"
#include "apps/weir/sweep/points.h"
#include "framework/base/log.h"
#include "framework/base/output_lock.h"

namespace weir::app {

struct SweepPlan {
  std::filesystem::path program;     ///< weir
  std::filesystem::path scene;       ///< a file
  std::filesystem::path folder;      ///< of the sweep; must be there when it runs
  PointList points;                  ///< all of them
  std::vector<std::size_t> chosen;   ///< those to run, from 0
  std::vector<std::string> options;  ///< of each run; "{}" stands for the folder of the point
  int jobs = 1;                      ///< runs at a time, 1 or more
  int threads = 1;                   ///< of all runs together
  std::vector<std::string> devices;  ///< which runs take in turns
  bool keepsCheckpoints = true;
};

/// Points that are done are left as they are. One that another sweep runs is waited for. What fails is kept
/// in the point's folder, and the others go on. A point goes on from its newest checkpoint, if it has one.
///
/// Ctrl-C and a warning (SIGUSR1) are passed on to all runs, and no others are started: see Interruption.
class Sweep {
 public:
  /// Throws an io Error if a folder holds results of another sweep.
  Sweep(SweepPlan plan, Log& log);

  /// The exit code: kInterrupted, kSavedForLater, else that of the first point that failed, else kDone.
  int run();

 private:
  using WallClock = std::chrono::steady_clock;

  struct Running {
    std::size_t point, slot;
    OutputLock lock;
    WallClock::time_point start;
    std::unique_ptr<ChildRun> child;
  };

  PointFolder folderOf(std::size_t point) const;
  std::vector<std::string> argumentsOf(std::size_t point, std::size_t slot) const;
  std::size_t freeSlot() const;
  /// Whether the point is done or runs now; false if another sweep runs it.
  bool tryStart(std::size_t point);
  void startMore();
  void reap();
  void passOnSignals();
  void handle(const Running& running, const ChildEnd& end);
  void keepFailure(std::size_t point, const PointError& error);
  /// Counts the point, and gives the words that say what became of it.
  std::string countedText(std::size_t point, const std::string& what);
  int exitCode() const;

  SweepPlan plan_;
  Log& log_;
  std::vector<Value> identities_;
  std::deque<std::size_t> waiting_;
  std::vector<std::unique_ptr<Running>> running_;
  WallClock::time_point nextTry_{};    // of points that others run
  std::map<std::size_t, int> failed_;  // exit codes by point
  int stopped_ = 0;                    // the exit code of a run that was ended by others, or 0
  std::size_t finished_ = 0;
  bool passedInterruption_ = false, passedWarning_ = false;
};

}  // namespace weir::app
