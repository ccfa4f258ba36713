#include "framework/run/output_worker.h"

#include <utility>

#include "framework/base/check.h"
#include "framework/run/stopwatch.h"

namespace weir {

void FirstError::keepCurrent() {
  const std::scoped_lock lock(mutex_);
  if (!error_) error_ = std::current_exception();
  any_ = true;
}

void FirstError::rethrowIfAny() const {
  if (!any_) return;
  std::exception_ptr error;
  {
    const std::scoped_lock lock(mutex_);
    error = error_;
  }
  std::rethrow_exception(error);  // unwinding takes locks of its own, so not with ours
}

void OutputWorker::frame(Simulation& simulation) {
  double waited = 0, captured = 0;
  std::unique_ptr<Snapshot> snapshot;
  {
    const Stopwatch watch(waited);
    // After an error nobody would write it.
    if (!waitForRoom(snapshot)) return;
  }
  {
    const Stopwatch watch(captured);
    snapshot = observer_.capture(simulation, std::move(snapshot));
  }
  push(std::move(snapshot));
  const std::scoped_lock lock(mutex_);
  time_.wait += waited;
  time_.capture += captured;
}

bool OutputWorker::waitForRoom(std::unique_ptr<Snapshot>& used) {
  std::unique_lock lock(mutex_);
  WEIR_CHECK(!ending_);
  changed_.wait(lock, [&] { return waiting_.size() < kMaxWaiting || failed_; });
  if (failed_) return false;
  if (used_.empty()) return true;
  used = std::move(used_.back());
  used_.pop_back();
  return true;
}

void OutputWorker::push(std::unique_ptr<Snapshot> snapshot) {
  if (!snapshot) return;
  const std::scoped_lock lock(mutex_);
  if (failed_) return;
  waiting_.push_back(std::move(snapshot));
  changed_.notify_all();
  if (!thread_.joinable()) thread_ = std::thread([this] { run(); });
}

void OutputWorker::wait() {
  double waited = 0;
  std::unique_lock lock(mutex_);
  {
    const Stopwatch watch(waited);
    changed_.wait(lock, [&] { return waiting_.empty() && !writing_; });
  }
  time_.wait += waited;
}

void OutputWorker::finish() {
  double waited = 0;
  {
    const Stopwatch watch(waited);
    {
      const std::scoped_lock lock(mutex_);
      ending_ = true;
      changed_.notify_all();
    }
    if (thread_.joinable()) thread_.join();
  }
  const std::scoped_lock lock(mutex_);
  time_.wait += waited;
}

OutputTime OutputWorker::time() {
  const std::scoped_lock lock(mutex_);
  OutputTime time = time_;
  time.name = observer_.name();
  time.parts = observer_.writeParts();
  return time;
}

void OutputWorker::run() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [&] { return !waiting_.empty() || ending_; });
    if (waiting_.empty()) return;
    std::unique_ptr<Snapshot> snapshot = std::move(waiting_.front());
    waiting_.pop_front();
    writing_ = true;
    changed_.notify_all();
    lock.unlock();
    double wrote = 0;
    const bool written = tryWrite(*snapshot, wrote);
    lock.lock();
    time_.write += wrote;
    used_.push_back(std::move(snapshot));
    writing_ = false;
    if (!written) {
      failed_ = true;
      waiting_.clear();
    }
    changed_.notify_all();
    if (failed_) return;
  }
}

bool OutputWorker::tryWrite(Snapshot& snapshot, double& seconds) {
  const Stopwatch watch(seconds);
  try {
    observer_.write(snapshot);
    return true;
  } catch (...) {
    errors_.keepCurrent();
    return false;
  }
}

}  // namespace weir
