// Lets an observer write its frames beside the simulation.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "framework/base/api.h"
#include "framework/run/observer.h"

namespace WEIR_API weir {

/// The first error of several threads.
class FirstError {
 public:
  /// Keeps the exception that is being handled, if it is the first.
  void keepCurrent();
  /// Cheap, so that it can be asked after every step.
  bool any() const { return any_; }
  void rethrowIfAny() const;

 private:
  mutable std::mutex mutex_;
  std::atomic<bool> any_ = false;
  std::exception_ptr error_;
};

/// One observer with its thread. A frame waits while two others do, so an observer that is slower than the
/// simulation holds it back, and no more than three snapshots are held.
class OutputWorker {
 public:
  static constexpr std::size_t kMaxWaiting = 2;

  /// The observer has begun; it and `errors` must outlive this.
  OutputWorker(Observer& observer, FirstError& errors) : observer_(observer), errors_(errors) {
    used_.reserve(kMaxWaiting + 1);  // so that the thread, which nobody catches, takes no memory
  }
  ~OutputWorker() { finish(); }
  OutputWorker(const OutputWorker&) = delete;
  OutputWorker& operator=(const OutputWorker&) = delete;

  Observer& observer() const { return observer_; }

  /// Captures the present frame and hands it to the thread, which starts with the first one. Throws what
  /// capture() throws. What write() throws is kept in `errors`; then the frames that wait are dropped.
  void frame(Simulation& simulation);
  /// Waits until all frames so far are written, or writing has failed. Until the next frame the observer is
  /// the caller's alone.
  void wait();
  /// Waits until all frames are written, and ends the thread. May be called again; frame() may not.
  void finish();

  /// What it cost so far; complete after finish().
  OutputTime time();

 private:
  /// Waits for room; false if writing has failed. `used` becomes a snapshot that has been written, if there
  /// is one.
  bool waitForRoom(std::unique_ptr<Snapshot>& used);
  void push(std::unique_ptr<Snapshot> snapshot);
  void run();
  bool tryWrite(Snapshot& snapshot, double& seconds);

  Observer& observer_;
  FirstError& errors_;
  std::thread thread_;
  std::mutex mutex_;  // of all that follows
  std::condition_variable changed_;
  std::deque<std::unique_ptr<Snapshot>> waiting_;
  std::vector<std::unique_ptr<Snapshot>> used_;
  bool writing_ = false, ending_ = false, failed_ = false;
  OutputTime time_;
};

}  // namespace weir
