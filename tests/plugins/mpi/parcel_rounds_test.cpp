// Rounds of parcels between threads, where an exchange ends once all that is sent in it has been received, a
// device does one after the other, and getting memory may wait for the device. If ranks waited for each other
// in a circle, these tests would not end.
#include "plugins/mpi/parcel_rounds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstring>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <random>
#include <stdexcept>
#include <thread>
#include <utility>

namespace weir::test {
namespace {

using Sizes = ParcelTransport::Sizes;
using Batch = ParcelTransport::Batch;
using Pair = std::pair<int, int>;  // from, to
using Bytes = std::span<std::byte>;
constexpr std::chrono::seconds kTooLong{20};

/// What ranks share: sizes that were announced, and bytes that stand ready to be received.
struct Meeting {
  struct Offer {
    Bytes bytes;
    bool isTaken = false;
  };
  std::mutex mutex;
  std::condition_variable changed;
  std::map<Pair, std::deque<Sizes>> announced;
  std::map<Pair, std::deque<Offer*>> offered;

  template <class F>
  void waitUntil(std::unique_lock<std::mutex>& lock, const F& isOver) {
    if (!changed.wait_for(lock, kTooLong, isOver)) throw std::runtime_error("a rank waits for ever");
  }
};

/// A device's work: one call after the other, on a thread of its own.
class Lane {
 public:
  ~Lane() {
    add([this] { ended_ = true; });
    thread_.join();
  }
  void add(std::function<void()> call) {
    const std::lock_guard lock(mutex_);
    calls_.push_back(std::move(call));
    changed_.notify_all();
  }
  void wait() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return calls_.empty(); });
  }

 private:
  void run() {
    while (!ended_) {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [&] { return !calls_.empty(); });
      const std::function<void()>& call = calls_.front();
      lock.unlock();
      call();
      lock.lock();
      calls_.pop_front();
      changed_.notify_all();
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
  FakeTransport(Meeting& meeting, int rank) : meeting_(meeting), rank_(rank), chance_(unsigned(rank)) {}

  void announce(int to, const Sizes& sizes) override {
    const std::lock_guard lock(meeting_.mutex);
    meeting_.announced[{rank_, to}].push_back(sizes);
    meeting_.changed.notify_all();
  }
  /// Now and then waits for the device as well, as whoever gets memory then may have to.
  Sizes announced(int from) override {
    std::unique_lock lock(meeting_.mutex);
    std::deque<Sizes>& all = meeting_.announced[{from, rank_}];
    meeting_.waitUntil(lock, [&] { return !all.empty(); });
    const Sizes sizes = std::move(all.front());
    all.pop_front();
    lock.unlock();
    if (chance_() % 3 == 0) synchronize();
    return sizes;
  }
  void exchange(std::vector<Batch> toRanks, std::vector<Batch>& fromRanks) override {
    std::vector<std::pair<int, Bytes>> received;
    for (std::size_t from = 0; from < fromRanks.size(); ++from)
      for (Array<std::byte>& one : fromRanks[from])
        if (!one.empty()) received.emplace_back(from, bytesOf(one));
    const auto kept = std::make_shared<std::vector<Batch>>(std::move(toRanks));
    device_.add([this, kept, received] { exchangeNow(*kept, received); });
    ++exchanges;
  }
  void synchronize() { device_.wait(); }

  int exchanges = 0;

 private:
  static Bytes bytesOf(Array<std::byte>& array) { return {array.data(), std::size_t(array.size())}; }

  void exchangeNow(std::vector<Batch>& sent, const std::vector<std::pair<int, Bytes>>& received) {
    std::deque<Meeting::Offer> offers;
    std::unique_lock lock(meeting_.mutex);
    for (std::size_t to = 0; to < sent.size(); ++to)
      for (Array<std::byte>& one : sent[to])
        if (!one.empty())
          meeting_.offered[{rank_, int(to)}].push_back(&offers.emplace_back(Meeting::Offer{bytesOf(one)}));
    meeting_.changed.notify_all();
    for (const auto& [from, bytes] : received) take(lock, from, bytes);
    meeting_.waitUntil(lock, [&] {
      return std::all_of(offers.begin(), offers.end(), [](const auto& offer) { return offer.isTaken; });
    });
  }
  void take(std::unique_lock<std::mutex>& lock, int from, Bytes into) {
    std::deque<Meeting::Offer*>& offered = meeting_.offered[{from, rank_}];
    meeting_.waitUntil(lock, [&] { return !offered.empty(); });
    Meeting::Offer& offer = *offered.front();
    offered.pop_front();
    ASSERT_EQ(offer.bytes.size(), into.size());
    std::memcpy(into.data(), offer.bytes.data(), into.size());
    offer.isTaken = true;
    meeting_.changed.notify_all();
  }

  Meeting& meeting_;
  int rank_;
  std::mt19937 chance_;
  Lane device_;
};

std::vector<std::byte> bytesOf(int what, std::int64_t size) {
  return std::vector<std::byte>(static_cast<std::size_t>(size), static_cast<std::byte>(what));
}

/// A rank that goes on while its device exchanges.
struct Rank {
  Rank(Meeting& meeting, int ownRank, int ranks)
      : rank(ownRank), size(ranks), transport(meeting, ownRank), rounds(transport, device, ownRank, ranks) {}

  void post(int to, int what, std::int64_t bytes) {
    rounds.post(to, Parcel(Array<std::byte>(device, bytesOf(what, bytes))));
  }
  std::vector<Parcel> receive(const std::vector<int>& from) { return rounds.receive(from); }

  int rank, size;
  CpuDevice device{1};
  FakeTransport transport;
  ParcelRounds rounds;
};

void onRanks(int size, const std::function<void(Rank&)>& work) {
  Meeting meeting;
  std::vector<std::jthread> threads;
  for (int rank = 0; rank < size; ++rank)
    threads.emplace_back([&, rank] {
      Rank own(meeting, rank, size);
      work(own);
      own.transport.synchronize();
    });
}

/// What goes from one rank to another in a round; all ranks know it, at random.
struct Traffic {
  unsigned seed;

  std::vector<std::int64_t> sizes(int round, int from, int to) const {
    std::seed_seq of{seed, unsigned(round), unsigned(from), unsigned(to)};
    std::mt19937 chance(of);
    std::vector<std::int64_t> sizes(std::max<std::size_t>(chance() % 5, 2) - 2);  // mostly nothing
    for (std::int64_t& size : sizes) size = chance() % 4 * 100;
    return sizes;
  }
};

/// What a rank has received, and what it should be.
struct Received {
  Parcel parcel;
  int what;
  std::int64_t size;
};

void exchangeAtRandom(Rank& own, const Traffic& traffic, int rounds) {
  std::vector<Received> all;
  for (int round = 0; round < rounds; ++round) {
    std::vector<int> from;
    std::vector<std::int64_t> sizes;
    for (int other = 0; other < own.size; ++other) {
      if (other == own.rank) continue;
      for (const std::int64_t size : traffic.sizes(round, own.rank, other))
        own.post(other, own.rank * 31 + round, size);
      for (const std::int64_t size : traffic.sizes(round, other, own.rank))
        from.push_back(other), sizes.push_back(size);
    }
    std::vector<Parcel> parcels = own.receive(from);
    for (std::size_t k = 0; k < parcels.size(); ++k)
      all.push_back({std::move(parcels[k]), from[k] * 31 + round, sizes[k]});
  }
  own.transport.synchronize();
  for (const Received& one : all) ASSERT_EQ(one.parcel.toHost(), bytesOf(one.what, one.size));
}

class ParcelRoundsOf : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Ranks, ParcelRoundsOf, testing::Values(2, 3, 4, 8),
                         testing::PrintToStringParamName());

TEST_P(ParcelRoundsOf, BringWhatAnyRanksSendEachOther) {
  for (unsigned seed = 0; seed < 5; ++seed)
    onRanks(GetParam(), [&](Rank& own) { exchangeAtRandom(own, {seed}, 60); });
}

TEST_P(ParcelRoundsOf, BringWhatAllSendToAll) {
  onRanks(GetParam(), [](Rank& own) {
    for (int round = 0; round < 20; ++round) {
      std::vector<int> others;
      for (int to = 0; to < own.size; ++to)
        if (to != own.rank) own.post(to, own.rank + round, 1000), others.push_back(to);
      std::vector<Parcel> parcels = own.receive(others);
      own.transport.synchronize();
      for (std::size_t k = 0; k < others.size(); ++k)
        EXPECT_EQ(parcels[k].toHost(), bytesOf(others[k] + round, 1000));
    }
  });
}

TEST(ParcelRounds, SeveralOfARankComeInTheirOrderWhereverItIsNamed) {
  onRanks(3, [](Rank& own) {
    if (own.rank > 0)
      for (int k = 0; k < 2; ++k) own.post(0, 10 * own.rank + k, k * 100);
    const std::vector<int> from = own.rank == 0 ? std::vector{2, 1, 1, 2} : std::vector<int>();
    const std::vector<Parcel> parcels = own.receive(from);
    own.transport.synchronize();
    const std::vector<std::pair<int, int>> expected{{20, 0}, {10, 0}, {11, 100}, {21, 100}};
    for (std::size_t k = 0; k < parcels.size(); ++k)
      EXPECT_EQ(parcels[k].toHost(), bytesOf(expected[k].first, expected[k].second));
    EXPECT_EQ(parcels.size(), from.size());
    EXPECT_EQ(own.transport.exchanges, 1);
  });
}

TEST(ParcelRounds, ParcelsMayAllBeEmpty) {
  onRanks(2, [](Rank& own) {
    own.post(1 - own.rank, 0, 0);
    EXPECT_EQ(own.receive({1 - own.rank}).at(0).size(), 0);
  });
}

}  // namespace
}  // namespace weir::test
