// The frame loop: what observers see and write and when, also when something fails or the run is interrupted.
#include "framework/run/run.h"

#include <gtest/gtest.h>

#include <atomic>
#include <memory>
#include <utility>
#include <vector>

#include "framework/run/statistics.h"
#include "tests/framework/run/bomb_run.h"
#include "tests/support/expect_error.h"

namespace weir {
namespace {

using test::Bomb;
using test::Recorder;
using RunTest = test::BombRun;

TEST_F(RunTest, ObserversSeeEveryFrame) {
  const auto s = simulation();
  Recorder recorder;
  Observer* observers[] = {&recorder};
  EXPECT_EQ(runSimulation(*s, observers), RunEnd::kFinished);
  EXPECT_EQ(recorder.calls, (Calls{"begin", "frame 0", "frame 1", "frame 2", "frame 3", "end finished"}));
  const auto& times = static_cast<Bomb&>(*s->scene().graph.find("bomb")).times;
  ASSERT_EQ(times.size(), 6u);
  for (std::size_t k = 0; k < times.size(); ++k) EXPECT_NEAR(times[k], 0.005 * double(k), 1e-15);
}

TEST_F(RunTest, EndsAtTheLastFrameThatIsAskedFor) {
  const auto s = simulation();
  Recorder recorder;
  Observer* observers[] = {&recorder};
  RunOptions options;
  options.lastFrame = 1;
  EXPECT_EQ(runSimulation(*s, observers, options), RunEnd::kFinished);
  EXPECT_EQ(recorder.calls, (Calls{"begin", "frame 0", "frame 1", "end finished"}));
  EXPECT_EQ(s->stepsDone(), 2);
}

TEST_F(RunTest, AnInterruptedRunClosesItsObservers) {
  const auto s = simulation();
  Recorder recorder;
  Observer* observers[] = {&recorder};
  std::atomic<bool> stop = false;
  RunOptions options;
  options.stop = &stop;
  options.onProgress = [&](const Simulation& now) { stop = now.stepsDone() == 3; };
  EXPECT_EQ(runSimulation(*s, observers, options), RunEnd::kInterrupted);
  EXPECT_EQ(recorder.calls, (Calls{"begin", "frame 0", "frame 1", "end interrupted"}));
}

TEST_F(RunTest, AFailingNodeIsNamedAndObserversAreClosed) {
  const auto s = simulation(R"({"fails_at": 2})");
  Recorder recorder;
  Observer* observers[] = {&recorder};
  const Error e = test::errorOf([&] { runSimulation(*s, observers); });
  EXPECT_EQ(e.location().node, "bomb");
  EXPECT_CONTAINS(e.what(), "boom");
  EXPECT_EQ(recorder.calls, (Calls{"begin", "frame 0", "frame 1", "end failed"}));
}

TEST_F(RunTest, AFailingObserverDoesNotKeepOthersFromTheirEnd) {
  for (const char* where : {"frame 1", "end finished"}) {
    const auto s = simulation();
    Recorder bad(where), good;
    Observer* observers[] = {&bad, &good};
    EXPECT_EQ(test::errorOf([&] { runSimulation(*s, observers); }).kind(), ErrorKind::kIo);
    EXPECT_TRUE(good.calls.back().starts_with("end")) << where;
  }
}

TEST_F(RunTest, AnObserverThatCannotBeginStopsTheRunBeforeItStarts) {
  const auto s = simulation();
  Recorder good, bad("begin"), never;
  Observer* observers[] = {&good, &bad, &never};
  test::errorOf([&] { runSimulation(*s, observers); });
  EXPECT_EQ(good.calls, (Calls{"begin", "end failed"}));
  EXPECT_TRUE(never.calls.empty());
  EXPECT_EQ(s->stepsDone(), 0);
}

TEST_F(RunTest, ProceedsFromWhereTheSimulationIs) {
  const auto s = simulation();
  s->reset();
  const std::atomic<bool> never = false;
  s->advanceFrame(never);
  Recorder recorder;
  Observer* observers[] = {&recorder};
  RunOptions options;
  options.proceed = true;
  options.lastFrame = 2;
  EXPECT_EQ(runSimulation(*s, observers, options), RunEnd::kFinished);
  EXPECT_EQ(recorder.calls, (Calls{"begin", "frame 1", "frame 2", "end finished"}));
  EXPECT_EQ(s->stepsDone(), 4);
}

TEST_F(RunTest, MayBecomeLongerOrShorterButNotThanItIs) {
  const auto s = simulation();
  s->reset();
  const std::atomic<bool> never = false;
  while (s->advanceFrame(never)) {
  }
  EXPECT_EQ(s->frame(), 3);
  s->setDuration(0.05);
  while (s->advanceFrame(never)) {
  }
  EXPECT_EQ(s->frame(), 5);
  EXPECT_DOUBLE_EQ(s->time(), 0.05);
  EXPECT_EQ(test::errorOf([&] { s->setDuration(0.04); }).kind(), ErrorKind::kUsage);
  s->setDuration(0.057);
  s->finishRest(never);
  EXPECT_NEAR(s->time(), 0.057, 1e-12);
  // The steps of the rest are not those of a frame.
  EXPECT_EQ(test::errorOf([&] { s->setDuration(0.07); }).kind(), ErrorKind::kUsage);
}

TEST_F(RunTest, AResetTakesTheWorldAsItIs) {
  const auto s = simulation();
  s->scene().world.dt.set(0.001);
  s->reset();
  s->step();
  EXPECT_DOUBLE_EQ(s->time(), 0.001);
}

TEST_F(RunTest, GivesTheSceneToAnotherSimulation) {
  auto s = simulation();
  s->reset();
  s->step();
  std::unique_ptr<Scene> scene = s->release();
  s.reset();
  Simulation other(std::move(scene), *device_, log_, registry_);
  other.reset();
  EXPECT_EQ(other.time(), 0);
}

TEST(TimeSummary, PercentilesAreElements) {
  const std::vector<double> times{4, 1, 3, 2};
  const TimeSummary s = summarize(times);
  EXPECT_EQ(s.median, 2);
  EXPECT_EQ(s.p95, 4);
  EXPECT_EQ(s.max, 4);
  EXPECT_EQ(s.mean, 2.5);
  EXPECT_EQ(summarize({}).p95, 0);
}

}  // namespace
}  // namespace weir
