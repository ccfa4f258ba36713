// Batches of parcels between threads, where sending ends once all of it has been received: if ranks waited
// for each other in a circle, these would not end.
#include "plugins/mpi/parcel_batches.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <condition_variable>
#include <cstring>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <utility>

namespace weir::test {
namespace {

using Sizes = ParcelTransport::Sizes;
using Pair = std::pair<int, int>;  // from, to
constexpr std::chrono::seconds kTooLong{20};

/// What ranks share: sizes that were announced, and arrays that stand ready to be received.
struct Meeting {
  struct Offer {
    const Array<std::byte>* bytes;
    bool isTaken = false;
  };
  std::mutex mutex;
  std::condition_variable changed;
  std::map<Pair, std::deque<Sizes>> announced;
  std::map<Pair, std::deque<Offer*>> offered;
};

/// A stream: calls one after the other, on a thread of its own.
class Lane {
 public:
  ~Lane() {
    add([this] { ended_ = true; });
    thread_.join();
  }
  void add(std::function<void()> call) {
    const std::lock_guard lock(mutex_);
    calls_.push_back(std::move(call));
    changed_.notify_one();
  }

 private:
  void run() {
    while (!ended_) {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [&] { return !calls_.empty(); });
      const std::function<void()> call = std::move(calls_.front());
      calls_.pop_front();
      lock.unlock();
      call();
    }
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> calls_;
  bool ended_ = false;
  std::thread thread_{[this] { run(); }};
};

class FakeTransport final : public ParcelTransport {
 public:
  FakeTransport(Meeting& meeting, int rank) : meeting_(meeting), rank_(rank) {}

  void announce(int to, const Sizes& sizes) override {
    const std::lock_guard lock(meeting_.mutex);
    meeting_.announced[{rank_, to}].push_back(sizes);
    meeting_.changed.notify_all();
  }
  std::optional<Sizes> announced(int from, std::optional<Seconds> patience) override {
    std::unique_lock lock(meeting_.mutex);
    std::deque<Sizes>& all = meeting_.announced[{from, rank_}];
    const bool isThere =
        meeting_.changed.wait_for(lock, patience.value_or(kTooLong), [&] { return !all.empty(); });
    if (!isThere && !patience) throw std::runtime_error("nothing was announced");
    if (!isThere) return std::nullopt;
    Sizes sizes = std::move(all.front());
    all.pop_front();
    ++batchesTaken;
    return sizes;
  }
  void mark() override {}
  void send(std::vector<Batch> toRanks) override {
    std::map<int, Batch> up, down;
    for (int to = 0; to < static_cast<int>(toRanks.size()); ++to)
      if (!toRanks[std::size_t(to)].empty())
        (to > rank_ ? up : down)[to] = std::move(toRanks[std::size_t(to)]);
    sendBy(up_, std::move(up));
    sendBy(down_, std::move(down));
  }
  /// Waits, so a rank is never ahead of its lanes.
  void receive(int from, std::span<Array<std::byte>> into) override {
    std::mutex mutex;
    std::condition_variable changed;
    bool isDone = false;
    (from < rank_ ? up_ : down_).add([&] {
      for (Array<std::byte>& one : into)
        if (!one.empty()) fill(from, one);
      const std::lock_guard lock(mutex);
      isDone = true;
      changed.notify_one();
    });
    std::unique_lock lock(mutex);
    changed.wait(lock, [&] { return isDone; });
  }

  int batchesTaken = 0;

 private:
  void sendBy(Lane& lane, std::map<int, Batch> batches) {
    const auto kept = std::make_shared<std::map<int, Batch>>(std::move(batches));
    lane.add([this, kept] {
      std::deque<Meeting::Offer> offers;
      std::unique_lock lock(meeting_.mutex);
      for (const auto& [to, batch] : *kept)
        for (const Array<std::byte>& one : batch)
          if (!one.empty())
            meeting_.offered[{rank_, to}].push_back(&offers.emplace_back(Meeting::Offer{&one}));
      meeting_.changed.notify_all();
      const bool allTaken = meeting_.changed.wait_for(lock, kTooLong, [&] {
        return std::all_of(offers.begin(), offers.end(), [](const auto& offer) { return offer.isTaken; });
      });
      EXPECT_TRUE(allTaken) << "rank " << rank_ << " waits for ever";
    });
  }
  void fill(int from, Array<std::byte>& into) {
    std::unique_lock lock(meeting_.mutex);
    std::deque<Meeting::Offer*>& offered = meeting_.offered[{from, rank_}];
    ASSERT_TRUE(meeting_.changed.wait_for(lock, kTooLong, [&] { return !offered.empty(); }));
    Meeting::Offer& offer = *offered.front();
    offered.pop_front();
    ASSERT_EQ(offer.bytes->size(), into.size());
    std::memcpy(into.data(), offer.bytes->data(), std::size_t(into.size()));
    offer.isTaken = true;
    meeting_.changed.notify_all();
  }

  Meeting& meeting_;
  int rank_;
  Lane up_, down_;
};

std::vector<std::byte> bytesOf(int what, std::int64_t size) {
  return std::vector<std::byte>(static_cast<std::size_t>(size), static_cast<std::byte>(what));
}

struct Rank {
  int rank, size;
  Device& device;
  FakeTransport& transport;
  ParcelBatches& batches;

  void post(int to, int what, std::int64_t bytes) {
    const std::vector<std::byte> values = bytesOf(what, bytes);
    batches.post(to, Parcel(Array<std::byte>(device, values)));
  }
  void expect(int from, int what, std::int64_t bytes) {
    EXPECT_EQ(batches.take(from).toHost(), bytesOf(what, bytes)) << "from " << from << " to " << rank;
  }
};

void onRanks(int size, const std::function<void(Rank)>& work) {
  Meeting meeting;
  std::vector<std::jthread> threads;
  for (int rank = 0; rank < size; ++rank)
    threads.emplace_back([&, rank] {
      CpuDevice device(1);
      FakeTransport transport(meeting, rank);
      ParcelBatches batches(transport, device, rank, size);
      work({rank, size, device, transport, batches});
      batches.flush();
    });
}

TEST(ParcelBatches, AllSendToAllWhereSendingWaitsForReceiving) {
  onRanks(4, [](Rank own) {
    for (int round = 0; round < 20; ++round) {
      const auto sizeOf = [&](int from, int to) { return (from * 7 + to * 3 + round) % 5 * 1000; };
      for (int to = 0; to < own.size; ++to)
        if (to != own.rank) own.post(to, own.rank * 10 + round, sizeOf(own.rank, to));
      for (int from = 0; from < own.size; ++from)
        if (from != own.rank) own.expect(from, from * 10 + round, sizeOf(from, own.rank));
    }
  });
}

TEST(ParcelBatches, SoDoNeighborsOfWhichTheOneAboveComesFirst) {
  onRanks(4, [](Rank own) {
    const auto neighbors = [&](const auto& f) {
      if (own.rank + 1 < own.size) f(own.rank + 1);
      if (own.rank > 0) f(own.rank - 1);
    };
    for (int round = 0; round < 20; ++round) {
      neighbors([&](int to) { own.post(to, own.rank, 100), own.post(to, own.rank + 50, 10 * round); });
      neighbors([&](int from) { own.expect(from, from, 100), own.expect(from, from + 50, 10 * round); });
    }
  });
}

TEST(ParcelBatches, WhatOneRankIsSentComesInOrderAndAsOneBatch) {
  onRanks(3, [](Rank own) {
    if (own.rank > 0) {
      for (int k = 0; k < 3; ++k) own.post(0, own.rank + k, k * 100);
      return;
    }
    for (int from = 1; from < own.size; ++from)
      for (int k = 0; k < 3; ++k) own.expect(from, from + k, k * 100);
    EXPECT_EQ(own.transport.batchesTaken, 2);
  });
}

TEST(ParcelBatches, ParcelsMayAllBeEmpty) {
  onRanks(2, [](Rank own) {
    own.post(1 - own.rank, 0, 0);
    own.expect(1 - own.rank, 0, 0);
  });
}

TEST(ParcelBatches, ARankMaySendToItself) {
  onRanks(2, [](Rank own) {
    own.post(own.rank, 3, 30);
    own.post(1 - own.rank, 4, 40);
    own.expect(own.rank, 3, 30);
    own.expect(1 - own.rank, 4, 40);
  });
}

TEST(ParcelBatches, WhoWaitsForAnAnswerHasSentTheQuestion) {
  onRanks(2, [](Rank own) {
    if (own.rank == 1) own.expect(0, 5, 50);
    own.post(1 - own.rank, 5 + own.rank, 50);
    if (own.rank == 0) own.expect(1, 6, 50);
  });
}

}  // namespace
}  // namespace weir::test
