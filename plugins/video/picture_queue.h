// Hands pictures over to background threads, so that drawing does not wait for encoders.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "plugins/video/picture.h"

namespace weir::rendering {

class PictureQueue {
 public:
  /// What is done with each picture; pictures are numbered from 0 in the order of push().
  using Work = std::function<void(std::int64_t number, const Picture& picture)>;

  /// At most `longest` pictures wait. With one thread, pictures are worked on in order.
  PictureQueue(int threads, std::size_t longest, Work work);
  /// Drops the pictures that wait, and waits for those that are being worked on.
  ~PictureQueue();
  PictureQueue(const PictureQueue&) = delete;
  PictureQueue& operator=(const PictureQueue&) = delete;

  /// Waits while the queue is full. Throws what the work on an earlier picture threw, the same from then on:
  /// after an error no more work is done.
  void push(Picture picture);
  /// Waits until all pictures are done. Throws as push() does.
  void wait();
  /// Waits until all pictures are done and ends the threads; push() may not be called any more. Throws as
  /// push() does. May be called again.
  void finish();
  /// Drops the pictures that wait; does not wait for those that are being worked on.
  void drop();

 private:
  struct Numbered {
    std::int64_t number;
    Picture picture;
  };

  void run();
  bool take(Numbered& next);
  void endThreads();

  const std::size_t longest_;
  const Work work_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Numbered> waiting_;
  std::int64_t pushed_ = 0, done_ = 0;
  bool ending_ = false;
  std::exception_ptr error_;
  std::vector<std::thread> threads_;
};

}  // namespace weir::rendering
