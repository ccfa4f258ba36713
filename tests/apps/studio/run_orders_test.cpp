// What waits for the simulation stays small, and nobody keeps others waiting.
#include "apps/studio/session/run_orders.h"

#include <gtest/gtest.h>

#include "apps/studio/server/allowance.h"
#include "apps/studio/session/question_queue.h"

namespace weir::studio {
namespace {

TEST(RunOrdersTest, AnOrderTakesThePlaceOfThoseItMakesVoid) {
  RunOrders orders;
  EXPECT_TRUE(orders.empty());
  orders.frames += 3;
  orders.addPlay();
  EXPECT_TRUE(orders.play);
  EXPECT_EQ(orders.frames, 0);
  orders.addPause();
  EXPECT_TRUE(orders.pause);
  EXPECT_FALSE(orders.play);
  orders.addChanges({{.node = "water", .module = "", .parameter = "spacing", .value = 1}});
  orders.serve = true;
  orders.addLoad({nullptr, "cpu"});
  EXPECT_TRUE(orders.serveFirst);  // of the simulation that goes
  EXPECT_FALSE(orders.serve);
  EXPECT_FALSE(orders.pause);
  EXPECT_TRUE(orders.changes.empty());
  EXPECT_FALSE(orders.empty());
}

TEST(RunOrdersTest, ChangesOfOneParameterAreOne) {
  RunOrders orders;
  for (int i = 0; i < 1000; ++i) {
    orders.addChanges({{.node = "water", .module = "solver", .parameter = "iterations", .value = i}});
    orders.addChanges({{.node = "water", .module = "", .parameter = "iterations", .value = -i}});
  }
  ASSERT_EQ(orders.changes.size(), 2u);
  EXPECT_EQ(orders.changes[0].value, Value(999));
  EXPECT_EQ(orders.changes[1].value, Value(-999));
}

TEST(QuestionQueueTest, ClientsTakeTurnsAndEachHasALimit) {
  QuestionQueue queue;
  std::string answered;
  std::size_t taken = 0;
  while (queue.add(7, [&](Simulation*) { answered += 'a'; })) ++taken;
  EXPECT_EQ(taken, QuestionQueue::kMaxOfAClient);
  EXPECT_TRUE(queue.add(9, [&](Simulation*) { answered += 'b'; }));
  EXPECT_TRUE(queue.add(8, [&](Simulation*) { answered += 'c'; }));
  for (int i = 0; i < 4; ++i) queue.next()(nullptr);
  EXPECT_EQ(answered, "acba");
  queue.forget(7);
  EXPECT_TRUE(queue.empty());
}

TEST(AllowanceTest, ABurstIsServedAtOnceAndAFloodAtItsShare) {
  using namespace std::chrono_literals;
  const Allowance::Clock::time_point start{};
  Allowance allowance(start);
  EXPECT_EQ(allowance.spend(Allowance::kMax / 2, 0.1, start).count(), 0);
  EXPECT_GT(allowance.spend(Allowance::kMax, 0.1, start).count(), 0);
  // However it goes on, it gets its share of the time, and a single message never costs it more than the
  // longest wait.
  Allowance::Clock::time_point now = start;
  Allowance::Seconds spent{};
  for (int i = 0; i < 10'000; ++i) {
    const auto wait = allowance.spend(1ms, 0.1, now);
    spent += 1ms;
    now += std::chrono::duration_cast<Allowance::Clock::duration>(wait);
  }
  EXPECT_NEAR(spent / Allowance::Seconds(now - start), 0.1, 0.01);
  EXPECT_LE(allowance.spend(1h, 0.1, now), Allowance::kLongestWait);
  EXPECT_EQ(allowance.spend(1us, 0.1, now + 1min).count(), 0);
}

}  // namespace
}  // namespace weir::studio
