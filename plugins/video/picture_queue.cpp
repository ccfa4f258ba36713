#include "plugins/video/picture_queue.h"

#include <utility>

#include "framework/base/check.h"

namespace weir::rendering {

PictureQueue::PictureQueue(int threads, std::size_t longest, Work work)
    : longest_(longest), work_(std::move(work)) {
  WEIR_CHECK(threads > 0);
  WEIR_CHECK(longest > 0u);
  for (int i = 0; i < threads; ++i) threads_.emplace_back([this] { run(); });
}

PictureQueue::~PictureQueue() {
  drop();
  endThreads();
}

void PictureQueue::push(Picture picture) {
  std::unique_lock lock(mutex_);
  WEIR_CHECK(!ending_);
  changed_.wait(lock, [&] { return waiting_.size() < longest_ || error_; });
  if (const std::exception_ptr error = error_) {
    lock.unlock();  // unwinding takes locks of its own
    std::rethrow_exception(error);
  }
  waiting_.push_back({pushed_++, std::move(picture)});
  changed_.notify_all();
}

void PictureQueue::wait() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return done_ == pushed_ || error_; });
  if (const std::exception_ptr error = error_) {
    lock.unlock();  // unwinding takes locks of its own
    std::rethrow_exception(error);
  }
}

void PictureQueue::finish() {
  endThreads();
  if (error_) std::rethrow_exception(error_);
}

void PictureQueue::drop() {
  const std::lock_guard lock(mutex_);
  waiting_.clear();
}

void PictureQueue::endThreads() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
    changed_.notify_all();
  }
  for (std::thread& thread : threads_) thread.join();
  threads_.clear();
}

bool PictureQueue::take(Numbered& next) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return !waiting_.empty() || ending_; });
  if (waiting_.empty()) return false;
  next = std::move(waiting_.front());
  waiting_.pop_front();
  changed_.notify_all();
  return true;
}

void PictureQueue::run() {
  Numbered next;
  while (take(next)) {
    try {
      work_(next.number, next.picture);
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (!error_) error_ = std::current_exception();
      waiting_.clear();
      changed_.notify_all();
    }
    const std::lock_guard lock(mutex_);
    ++done_;
    changed_.notify_all();
  }
}

}  // namespace weir::rendering
