// Ranks as threads of one process: what is posted arrives in its order, sums and gathers are those of all,
// and whoever fails ends all.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <string>
#include <thread>

#include "framework/base/check.h"
#include "framework/base/error.h"
#include "framework/communication/thread_ranks.h"
#include "tests/support/expect_error.h"

namespace weir::test {
namespace {

Message messageOf(int number) {
  return {std::byte(number), std::byte(number / 256)};
}

TEST(ThreadRanks, MessagesOfARankArriveInTheirOrderAndFromTheRankThatIsAsked) {
  constexpr int kRanks = 5, kMessages = 300;
  std::atomic<int> right = 0;
  runOnThreads(kRanks, [&](Communicator& ranks) {
    for (int k = 0; k < kMessages; ++k)
      for (int to = 0; to < kRanks; ++to) ranks.post(to, messageOf(k + 7 * ranks.rank() + 13 * to));
    for (int from = kRanks - 1; from >= 0; --from)
      for (int k = 0; k < kMessages; ++k)
        right += ranks.receive(from) == messageOf(k + 7 * from + 13 * ranks.rank()) ? 1 : 0;
  });
  EXPECT_EQ(right, kRanks * kRanks * kMessages);
}

TEST(ThreadRanks, MessagesMayBeEmptyAndGoToOneself) {
  std::atomic<int> arrived = 0;
  runOnThreads(1, [&](Communicator& ranks) {
    ranks.post(0, {});
    ranks.post(0, messageOf(9));
    arrived += ranks.receive(0).empty() ? 1 : 0;
    arrived += ranks.receive(0) == messageOf(9) ? 1 : 0;
  });
  EXPECT_EQ(arrived, 2);
}

TEST(ThreadRanks, EveryRankRunsOnceAndKnowsItsNumber) {
  constexpr int kRanks = 8;
  std::atomic<int> seen = 0;
  runOnThreads(kRanks, [&](Communicator& ranks) {
    EXPECT_EQ(ranks.size(), kRanks);
    seen += 1 << ranks.rank();
  });
  EXPECT_EQ(seen, (1 << kRanks) - 1);
}

TEST(ThreadRanks, SumsLargestAndGatheredAreOfAllOnEveryRank) {
  constexpr int kRanks = 4;
  runOnThreads(kRanks, [&](Communicator& ranks) {
    const int rank = ranks.rank();
    const std::int64_t large = (std::int64_t{1} << 60) * (rank % 2 == 0 ? 1 : -1);
    std::int64_t values[] = {rank, large + rank, 1};
    ranks.sum(values);
    EXPECT_EQ(values[0], 6);
    EXPECT_EQ(values[1], 6);
    EXPECT_EQ(values[2], kRanks);
    EXPECT_EQ(ranks.max(-1.5 * rank), 0);
    EXPECT_EQ(ranks.max(float(rank)), 3);
    EXPECT_EQ(ranks.allGather(10 * rank), (std::vector<int>{0, 10, 20, 30}));
    EXPECT_TRUE(ranks.any(rank == 2));
    EXPECT_FALSE(ranks.any(false));
  });
}

TEST(ThreadRanks, OneThatFailsEndsAllThatWaitForItAndItsErrorIsThrown) {
  std::atomic<int> ended = 0;
  const auto run = [&] {
    runOnThreads(4, [&](Communicator& ranks) {
      if (ranks.rank() == 2) throw simulationError("the disk is gone", "a disk", "put it back");
      try {
        ranks.receive(3);
      } catch (const RanksEnded&) {
        ++ended;
        throw;
      }
    });
  };
  const Error error = errorOf(run);
  EXPECT_EQ(error.kind(), ErrorKind::kSimulation);
  EXPECT_EQ(error.message(), "rank 2: the disk is gone");
  EXPECT_EQ(error.allowed(), "a disk");
  EXPECT_EQ(error.hint(), "put it back");
  EXPECT_EQ(ended, 3);
}

TEST(ThreadRanks, WhatWasPostedBeforeAFailureIsNotTakenForGood) {
  EXPECT_THROW(runOnThreads(2,
                            [](Communicator& ranks) {
                              ranks.post(1 - ranks.rank(), messageOf(1));
                              if (ranks.rank() == 1) throw std::runtime_error("no way on");
                              for (;;) ranks.receive(1);
                            }),
               std::runtime_error);
}

TEST(ThreadRanks, WhoeverWaitsForARankThatHasEndedIsToldAndDoesNotHang) {
  EXPECT_THROW(runOnThreads(2,
                            [](Communicator& ranks) {
                              if (ranks.rank() == 1) ranks.receive(0);
                            }),
               InternalError);
}

TEST(ThreadRanks, AMistakeInTheSceneNamesNoRankAsItIsThatOfAll) {
  const auto run = [] {
    runOnThreads(3, [](Communicator&) { throw sceneError("there is no water").inNode("sea"); });
  };
  const Error error = errorOf(run);
  EXPECT_EQ(error.message(), "there is no water");
  EXPECT_EQ(error.location().node, "sea");
}

TEST(ThreadRanks, OneThatIsSilentEndsAllIfThatIsAsked) {
  ::setenv("WEIR_RANK_TIMEOUT", "0.1", 1);
  std::atomic<bool> told = false;
  const Error error = errorOf([&] {
    runOnThreads(2, [&](Communicator& ranks) {
      constexpr int kMost = 20'000;  // ms
      for (int i = 0; i < kMost && ranks.rank() == 1 && !told; ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      try {
        ranks.sum(1);
      } catch (...) {
        told = true;
        throw;
      }
    });
  });
  ::setenv("WEIR_RANK_TIMEOUT", "soon", 1);
  const Error wrong = errorOf([] { runOnThreads(2, [](Communicator&) {}); });
  ::unsetenv("WEIR_RANK_TIMEOUT");
  EXPECT_CONTAINS(error.what(), "rank 1 has not been heard of");
  EXPECT_CONTAINS(wrong.what(), "WEIR_RANK_TIMEOUT is soon");
}

}  // namespace
}  // namespace weir::test
