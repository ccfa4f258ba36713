// Runs on ranks that end before their time, by a process that is killed or stopped, by a signal or by an
// error, and those that go on from a checkpoint on another number of ranks.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "framework/scene/scene_file.h"
#include "plugins/vtkhdf/checkpoint_file.h"
#include "tests/plugins/outputs/meanwhile.h"
#include "tests/plugins/outputs/ranks_run.h"
#include "tests/support/child_process.h"
#include "tests/support/expect_error.h"

namespace weir::test {
namespace {

TEST_F(RanksTest, ACheckpointOfAnyNumberOfRanksGoesOnOnAnyOther) {
  scene_ = folder_.write("jet.json", kJet);
  const std::vector<std::string> coarse{"water.spacing=0.05"};
  const Outcome whole = run("whole", coarse, {"--ranks", "3", "--frames", "8"});
  ASSERT_EQ(whole.result.code, 0) << whole.result.err;
  for (const std::string from : {"1", "3"}) {
    const std::string checkpoint = folder_ / (from + ".h5");
    const ChildResult begun = save(checkpoint, coarse.front(), {"--ranks", from});
    ASSERT_EQ(begun.code, 0) << begun.err;
    for (const std::string to : {"1", "2", "4"})
      expectSameEnd(run(from + "to" + to, coarse, {"--ranks", to, "--frames", "8", "--resume", checkpoint}),
                    whole, "from " + from + " to " + to);
  }
  const Outcome alone =
      run("alone", coarse, {"--device", "cpu", "--frames", "8", "--resume", folder_ / "3.h5"});
  EXPECT_EQ(alone.result.code, 0) << alone.result.err;
}

TEST_F(RanksTest, ACheckpointWithoutRanksGoesOnAlikeOnAnyNumber) {
  scene_ = folder_.write("jet.json", kJet);
  const std::vector<std::string> coarse{"water.spacing=0.05"};
  const std::string checkpoint = folder_ / "alone.h5";
  const ChildResult begun = save(checkpoint, coarse.front(), {"--device", "cpu"});
  ASSERT_EQ(begun.code, 0) << begun.err;
  const Outcome one = run("one", coarse, {"--ranks", "1", "--frames", "8", "--resume", checkpoint}),
                three = run("three", coarse, {"--ranks", "3", "--frames", "8", "--resume", checkpoint});
  ASSERT_EQ(one.result.code, 0) << one.result.err;
  expectSameEnd(three, one, "from none to 3");
}

TEST_F(RanksTest, WhereAProcessOfMpiIsKilledAllEndAndTheCheckpointGoesOn) {
  if (!hasMpi()) GTEST_SKIP() << "there is no MPI, or it was not there when this was built";
  scene_ = folder_.write("jet.json", kJet);
  rest_.clear();       // the killed run has none
  duration_ = "1000";  // its process is killed before, however slow this one is
  const std::vector<std::string> coarse{"water.spacing=0.05"};
  const std::string checkpoint = folder_ / "killed.h5";
  // As soon as there is a checkpoint, whatever comes on stderr meanwhile.
  Meanwhile killer([&](int launcher) {
    const std::vector<int> ranks = childrenOf(launcher);
    return std::filesystem::exists(checkpoint) && ranks.size() == 3 && ::kill(ranks[1], SIGKILL) == 0;
  });
  const ChildResult killed = runByMpi(3,
                                      {"run", scene_, "--duration", duration_, "--set", coarse.front(),
                                       "--checkpoint", checkpoint, "--checkpoint-every", "2"},
                                      killer.options());
  EXPECT_NE(killed.code, 0);
  EXPECT_FALSE(killed.timedOut) << killed.err;
  std::int64_t saved = 0;
  const Checkpoint newest = Hdf5CheckpointStore().read(checkpoint);
  StateReader(newest.state).in("clock").get("frame", saved);
  const std::string last = std::to_string(saved + 8);
  const Outcome whole = run("whole", coarse, {"--ranks", "2", "--frames", last});
  ASSERT_EQ(whole.result.code, 0) << whole.result.err;
  expectSameEnd(run("resumed", coarse, {"--ranks", "4", "--frames", last, "--resume", checkpoint}), whole,
                "after a kill");
}

TEST_F(RanksTest, WhereAProcessOfMpiIsStoppedAllEndAndOneSaysWhichItIs) {
  if (!hasMpi()) GTEST_SKIP() << "there is no MPI, or it was not there when this was built";
  scene_ = folder_.write("jet.json", kJet);
  const std::string series = folder_ / "series.jsonl";
  std::atomic<int> stopped = 0;
  Meanwhile stopper([&](int launcher) {
    const std::vector<int> ranks = childrenOf(launcher);
    if (!std::filesystem::exists(series) || ranks.size() != 3) return false;
    stopped = ranks[1];
    return ::kill(stopped, SIGSTOP) == 0;
  });
  const ChildResult ended =
      runByMpi(3, {"run", scene_, "--duration", "100000", "--set", "water.spacing=0.05", "--series", series},
               stopper.options());
  EXPECT_FALSE(ended.timedOut) << ended.err;
  EXPECT_NE(ended.code, 0);
  EXPECT_CONTAINS(ended.err, "(process " + std::to_string(stopped) + " on ");
  EXPECT_CONTAINS(ended.err, "has not answered for 10 s");
}

TEST_F(RanksTest, AnInterruptedRunEndsOnAllRanksWithItsStatistics) {
  const std::string series = folder_ / "series.jsonl";
  const auto hasSteps = [&] {
    const std::string lines = readFile(series);
    return std::count(lines.begin(), lines.end(), '\n') > 1;
  };
  ChildOptions options;
  options.onStderr = [&, sent = false](int pid, const std::string&) mutable {
    constexpr int kMost = 20'000;  // ms
    for (int i = 0; i < kMost && !hasSteps(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    if (!std::exchange(sent, true)) ::kill(pid, SIGINT);
  };
  const ChildResult result =
      runWeir({"run", resourcesFolder() + "/scenes/dam_break.json", "--ranks", "3", "--duration", "1000",
               "--set", kCoarse, "--stats", folder_ / "stats.json", "--series", series},
              options);
  EXPECT_EQ(result.code, 130) << result.err;
  const Value statistics = parseJson(readFile(folder_ / "stats.json"), "stats.json");
  EXPECT_EQ(statistics.find("end")->asString(), "interrupted");
  EXPECT_GT(statistics.find("steps")->asInt(), 0);
  EXPECT_EQ(statistics.find("nodes")->find("water")->find("particles")->asInt(), 1000);
}

TEST_F(RanksTest, ARunThatDivergesEndsOnAllRanksWithOneMessage) {
  const Outcome diverged =
      run("diverged", {kCoarse, "water.solver.enabled=false", "block.velocity=[1e38, 1e38, 1e38]"},
          {"--ranks", "4"});
  EXPECT_EQ(diverged.result.code, 4);
  EXPECT_CONTAINS(diverged.result.err, "rank 0");
  EXPECT_CONTAINS(diverged.result.err, "diverged");
}

}  // namespace
}  // namespace weir::test
