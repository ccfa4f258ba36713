#include "framework/communication/thread_ranks.h"

#include <chrono>
#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <variant>

#include "framework/base/check.h"
#include "framework/base/error.h"
#include "framework/communication/wait_limit.h"

namespace weir {

namespace {

/// In memory, or on a device.
using Posted = std::variant<Message, Parcel>;

/// What the ranks share.
class Post {
 public:
  explicit Post(int ranks)
      : ranks_(ranks),
        boxes_(std::size_t(ranks) * std::size_t(ranks)),
        waiting_(std::size_t(ranks)),
        ended_(std::size_t(ranks)) {}

  int ranks() const { return ranks_; }

  void put(int from, int to, Posted message) {
    std::unique_lock lock(mutex_);
    box(from, to).push_back(std::move(message));
    Waiting& receiver = waiting_[std::size_t(to)];
    const bool isAwaited = receiver.from == from;
    // Whoever wakes needs the lock.
    lock.unlock();
    if (isAwaited) receiver.wake.notify_one();
  }

  Posted take(int from, int to) {
    std::unique_lock lock(mutex_);
    std::deque<Posted>& messages = box(from, to);
    Waiting& receiver = waiting_[std::size_t(to)];
    const auto isOver = [&] { return failed_ || !messages.empty() || ended_[std::size_t(from)]; };
    receiver.from = from;
    if (!limit_)
      receiver.wake.wait(lock, isOver);
    else if (!receiver.wake.wait_for(lock, *limit_, isOver))
      throw waitedTooLong(from, *limit_);
    receiver.from.reset();
    if (failed_) throw RanksEnded();
    const bool othersMakeTheSameCalls = !messages.empty();
    WEIR_CHECK(othersMakeTheSameCalls);
    Posted message = std::move(messages.front());
    messages.pop_front();
    return message;
  }

  /// The rank posts nothing any more.
  void end(int rank) {
    const std::lock_guard lock(mutex_);
    ended_[std::size_t(rank)] = true;
    wakeAll();
  }

  /// In a catch block.
  void fail(int rank) {
    const std::lock_guard lock(mutex_);
    if (!failed_) failed_ = std::current_exception(), failedRank_ = rank;
    wakeAll();
  }

  /// Once all ranks have ended.
  void rethrowIfFailed() const {
    if (!failed_) return;
    try {
      std::rethrow_exception(failed_);
    } catch (const Error& e) {
      const bool ofAll = e.kind() == ErrorKind::kScene || e.kind() == ErrorKind::kUsage;
      if (ofAll || ranks_ == 1) throw;
      throw Error(e.kind(), "rank " + std::to_string(failedRank_) + ": " + e.message(), e.allowed(), e.hint())
          .at(e.location());
    }
  }

 private:
  /// A rank that waits for a message. Each is woken by itself: with one condition for all, every message
  /// would wake every rank, most of them in vain.
  struct Waiting {
    std::optional<int> from;  // of which rank, while it waits
    std::condition_variable wake;
  };

  void wakeAll() {
    for (Waiting& each : waiting_) each.wake.notify_one();
  }

  std::deque<Posted>& box(int from, int to) {
    const bool areRanks = from >= 0 && from < ranks_ && to >= 0 && to < ranks_;
    WEIR_CHECK(areRanks);
    return boxes_[std::size_t(to) * std::size_t(ranks_) + std::size_t(from)];
  }

  int ranks_;
  std::optional<std::chrono::duration<double>> limit_ = rankWaitLimit();
  std::mutex mutex_;  // of all below
  std::vector<std::deque<Posted>> boxes_;
  std::vector<Waiting> waiting_;  // by rank
  std::vector<bool> ended_;
  std::exception_ptr failed_;
  int failedRank_ = 0;
};

class ThreadRank final : public Communicator {
 public:
  ThreadRank(Post& post, int rank) : post_(post), rank_(rank) {}

  int rank() const override { return rank_; }
  int size() const override { return post_.ranks(); }
  int sizeHere() const override { return post_.ranks(); }
  void post(int to, Message message) override { post_.put(rank_, to, std::move(message)); }
  Message receive(int from) override { return std::get<Message>(post_.take(from, rank_)); }
  void postParcel(int to, Parcel parcel) override { post_.put(rank_, to, std::move(parcel)); }
  std::vector<Parcel> receiveParcels(std::span<const int> from, Device&) override {
    std::vector<Parcel> parcels;
    for (const int rank : from) parcels.push_back(std::get<Parcel>(post_.take(rank, rank_)));
    return parcels;
  }

 private:
  Post& post_;
  int rank_;
};

}  // namespace

void runOnThreads(int ranks, const std::function<void(Communicator&)>& work) {
  WEIR_CHECK(ranks > 0);
  Post post(ranks);
  const auto run = [&](int rank) {
    try {
      ThreadRank communicator(post, rank);
      work(communicator);
      post.end(rank);
    } catch (...) {
      post.fail(rank);
    }
  };
  {
    std::vector<std::jthread> threads;
    try {
      for (int rank = 1; rank < ranks; ++rank) threads.emplace_back(run, rank);
      run(0);
    } catch (...) {
      post.fail(0);  // the system gives no more threads
    }
  }
  post.rethrowIfFailed();
}

}  // namespace weir
