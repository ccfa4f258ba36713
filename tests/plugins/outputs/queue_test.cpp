// What queues do to runs and sweeps: warn them, kill them, and start them again.
#include <gtest/gtest.h>
#include <sys/prctl.h>
#include <sys/wait.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <random>
#include <sstream>
#include <thread>
#include <utility>

#include "framework/scene/scene_file.h"
#include "tests/plugins/outputs/written_run.h"
#include "tests/support/child_process.h"
#include "tests/support/expect_error.h"
#include "tests/support/find_program.h"

namespace weir::test {
namespace {

namespace fs = std::filesystem;

constexpr const char* kDrop = R"({
  "weir": 1,
  "world": { "dt": 0.002, "duration": 1000, "frame_rate": 250 },
  "nodes": {
    "block": { "type": "BoxSampler", "params": { "min": [0, 0.1, 0], "max": [0.2, 0.3, 0.2] } },
    "tank": { "type": "StaticBoundary",
              "params": { "shape": "box", "min": [0, 0, 0], "max": [0.5, 0.5, 0.2], "inverted": true } },
    "water": { "type": "ParticleFluid", "params": { "spacing": 0.05, "rest_steps": 0 } }
  },
  "links": [ "block.particles -> water.initial", "tank.boundary -> water.boundaries" ]
})";

class Queue : public testing::Test {
 protected:
  Queue() : scene(folder.write("drop.json", kDrop)) {}

  std::string file(const std::string& run, const std::string& ending) const {
    return folder / (run + "." + ending);
  }

  ChildResult run(const std::string& name, const std::vector<std::string>& more,
                  const ChildOptions& options = {}) const {
    std::vector<std::string> all{
        "run", scene, "--device", "cpu", "--stats", file(name, "json"), "--series", file(name, "jsonl")};
    all.insert(all.end(), more.begin(), more.end());
    return runWeir(all, options);
  }
  std::vector<std::string> checkpointed(const std::string& name) const {
    return {"--checkpoint", file(name, "h5"), "--resume", "auto"};
  }
  /// A run that gets the signal once it has begun.
  ChildResult runAndSend(int signal, const std::string& name, const std::vector<std::string>& more) const {
    ChildOptions options;
    bool sent = false;
    options.onStderr = [&](int pid, const std::string& err) {
      if (!sent && contains(err, "frame ")) sent = ::kill(pid, signal) == 0;
    };
    return run(name, more, options);
  }
  std::int64_t framesOf(const std::string& name) const {
    return parseJson(readFile(file(name, "json")), name).find("frames")->asInt();
  }
  /// `name` must have ended at frame `frames` as a run that nobody disturbed.
  void expectAsUndisturbed(const std::string& name, std::int64_t frames) const {
    ASSERT_EQ(run("whole", {"--frames", std::to_string(frames)}).code, 0);
    expectSameSeries(file("whole", "jsonl"), file(name, "jsonl"));
  }

  TemporaryFolder folder;
  std::string scene;
};

std::vector<std::string> joined(std::vector<std::string> all, const std::vector<std::string>& more) {
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

TEST_F(Queue, AWarnedRunSavesAndGoesOnLaterAsIfNothingHadBeen) {
  const ChildResult warned = runAndSend(SIGUSR1, "run", checkpointed("run"));
  EXPECT_EQ(warned.code, 75) << warned.err;
  EXPECT_CONTAINS(warned.err, "saved, to go on later");
  EXPECT_CONTAINS(warned.err, "from the start");
  const std::int64_t saved = framesOf("run");
  const std::string last = std::to_string(saved + 5);
  const ChildResult resumed = run("run", joined(checkpointed("run"), {"--frames", last}));
  EXPECT_EQ(resumed.code, 0) << resumed.err;
  EXPECT_CONTAINS(resumed.err, "going on from ");
  expectAsUndisturbed("run", saved + 5);
}

TEST_F(Queue, AWarnedRunThatMayNotSaveEndsAsAnInterruptedOne) {
  const ChildResult warned = runAndSend(SIGUSR1, "run", {});
  EXPECT_EQ(warned.code, 130) << warned.err;
}

TEST_F(Queue, TheNewestCheckpointThatIsWholeIsTaken) {
  const std::vector<std::string> every = joined(checkpointed("run"), {"--checkpoint-every", "2"});
  ASSERT_EQ(run("run", joined(every, {"--frames", "5"})).code, 0);
  const std::string newest = file("run", "h5"), previous = file("run", "previous.h5");
  ASSERT_TRUE(fs::exists(previous));
  // Of another scene: refused, and nothing is touched.
  const std::string series = readFile(file("run", "jsonl"));
  const ChildResult other = run("run", joined(every, {"--frames", "5", "--set", "water.spacing=0.04"}));
  EXPECT_EQ(other.code, 5);
  EXPECT_CONTAINS(other.err, "the checkpoint is of another run");
  EXPECT_EQ(readFile(file("run", "jsonl")), series);
  // The newest one is cut: the one before is taken.
  fs::resize_file(newest, fs::file_size(newest) / 2);
  const ChildResult before = run("run", joined(every, {"--frames", "5"}));
  EXPECT_EQ(before.code, 0) << before.err;
  EXPECT_CONTAINS(before.err, "going on without a checkpoint: ");
  EXPECT_CONTAINS(before.err, "going on from " + previous);
  expectAsUndisturbed("run", 5);
  // Both are cut: from the start.
  for (const std::string& checkpoint : {newest, previous}) fs::resize_file(checkpoint, 100);
  const ChildResult anew = run("run", joined(every, {"--frames", "6"}));
  EXPECT_EQ(anew.code, 0) << anew.err;
  EXPECT_CONTAINS(anew.err, "from the start");
  expectAsUndisturbed("run", 6);
  const ChildResult nowhere = run("run", {"--resume", "auto"});
  EXPECT_EQ(nowhere.code, 2);
  EXPECT_CONTAINS(nowhere.err, "--resume auto is given without --checkpoint");
}

TEST_F(Queue, ASignalBeforeTheFirstStepLeavesNoLockBehind) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGINT, SIGTERM, SIGHUP}) {  // at slightly other moments
    ChildOptions options;
    bool sent = false;
    options.onStderr = [&](int pid, const std::string&) {
      if (!std::exchange(sent, true)) ::kill(pid, signal);
    };
    const ChildResult ended = run("early", checkpointed("early"), options);
    EXPECT_EQ(ended.code, 130) << ended.err;
    EXPECT_FALSE(fs::exists(folder / ".early.json.lock")) << signal;
    EXPECT_FALSE(fs::exists(folder / ".early.h5.lock")) << signal;
  }
}

/// Three points of some tenths of a second each, and one that fails.
class SweepInQueue : public Queue {
 protected:
  std::vector<std::string> sweep(const std::string& out) const {
    return {"sweep",    scene,
            "--set",    "water.spacing=0.05,0.04,-1,0.03",
            "--out",    folder / out,
            "--jobs",   "2",
            "--device", "cpu",
            "--",       "--frames",
            "150",      "--checkpoint-every",
            "10"};
  }
  std::string table(const std::string& out) const { return readFile(folder / out + "/table.csv"); }

  /// Waits until some point has a checkpoint; false if none comes.
  bool waitForCheckpoint(const std::string& out) const {
    for (int i = 0; i < 2000; ++i) {
      if (fs::exists(folder / out + "/water.spacing=0.05/checkpoint.h5")) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return false;
  }
  ChildResult sweepAndSend(int signal, const std::string& out) const {
    ChildOptions options;
    bool sent = false;
    options.onStderr = [&](int pid, const std::string&) {
      if (!sent && waitForCheckpoint(out)) sent = ::kill(pid, signal) == 0;
    };
    return runWeir(sweep(out), options);
  }
  bool isFirstPointDone(const std::string& out) const {
    std::istringstream lines(table(out));
    for (std::string line; std::getline(lines, line);)
      if (contains(line, "water.spacing=0.05")) return contains(line, ",done,");
    return false;
  }
  /// While the first point has a checkpoint and is not done. Where this process is held up, the signal comes
  /// too late, and all is done again.
  ChildResult sweepAndSendInTime(int signal, const std::string& out) const {
    constexpr int kTries = 20;
    for (int i = 1;; ++i) {
      ChildResult ended = sweepAndSend(signal, out);
      if (i == kTries || !isFirstPointDone(out)) return ended;
      fs::remove_all(folder / out);
    }
  }
};

TEST_F(SweepInQueue, InterruptedOrWarnedItEndsItsRunsAndGoesOnLater) {
  ASSERT_EQ(runWeir(sweep("whole")).code, 3);
  for (const auto& [signal, code] : {std::pair{SIGINT, 130}, {SIGUSR1, 75}}) {
    SCOPED_TRACE(signal);
    const std::string out = "out" + std::to_string(signal);
    const ChildResult ended = sweepAndSendInTime(signal, out);
    EXPECT_EQ(ended.code, code) << ended.err;
    // No run is left that holds an output.
    for (const auto& entry : fs::recursive_directory_iterator(folder / out))
      EXPECT_NE(entry.path().extension(), ".lock") << entry.path();
    EXPECT_TRUE(fs::exists(folder / out + "/water.spacing=0.05/checkpoint.h5"));
    EXPECT_CONTAINS(table(out), ",open,");
    const ChildResult repeated = runWeir(sweep(out));
    EXPECT_EQ(repeated.code, 3) << repeated.err;
    EXPECT_EQ(table(out), table("whole"));
    EXPECT_FALSE(fs::exists(folder / out + "/water.spacing=0.05/checkpoint.h5"));
  }
}

TEST_F(SweepInQueue, KilledAndRepeatedItHasTheSameTable) {
  if (findProgram("timeout").empty()) GTEST_SKIP() << "the program timeout, of coreutils, is not there";
  const auto start = std::chrono::steady_clock::now();
  ASSERT_EQ(runWeir(sweep("whole")).code, 3);
  double took = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::mt19937 random(7);
  ::prctl(PR_SET_CHILD_SUBREAPER, 1);  // to see the end of the runs, which end where their sweep does
  int kills = 0;
  for (int trial = 0; trial < 4 || (kills == 0 && trial < 20); ++trial) {
    const double after = took * std::uniform_real_distribution(0.1, 0.5)(random);
    const ChildResult killed =
        runChild(findProgram("timeout"),
                 joined({"-s", "KILL", std::to_string(after), weirProgram()}, sweep("killed")));
    if (killed.signal == SIGKILL) {
      ++kills;  // the next one begins while runs of this one may still be ending
    } else if (kills == 0) {
      // The machine was busier before: once more, and sooner.
      fs::remove_all(folder / "killed");
      took /= 2;
    }
  }
  EXPECT_GT(kills, 0);
  const ChildResult repeated = runWeir(sweep("killed"));
  while (::waitpid(-1, nullptr, 0) > 0) {
  }
  ::prctl(PR_SET_CHILD_SUBREAPER, 0);
  EXPECT_EQ(repeated.code, 3) << repeated.err;
  EXPECT_EQ(table("killed"), table("whole"));
}

}  // namespace
}  // namespace weir::test
