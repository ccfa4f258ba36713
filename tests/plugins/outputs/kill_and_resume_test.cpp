// Kill -9 at random moments: what a run with checkpoints has written stays readable, and resumed it ends, bit
// by bit, as one that was left alone.
//
// WEIR_TEST_KILLS is how often the run is killed on each back end, 3 without it. For more:
//   WEIR_TEST_KILLS=20 build/cpu/bin/weir_outputs_tests --gtest_filter='*KillAndResume*'
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <random>

#include "framework/scene/scene_file.h"
#include "plugins/vtkhdf/checkpoint_file.h"
#include "plugins/vtkhdf/hdf5.h"
#include "plugins/vtkhdf/vtkhdf_writer.h"
#include "tests/plugins/outputs/written_run.h"
#include "tests/plugins/video/video_tools.h"
#include "tests/support/devices.h"

namespace weir::test {
namespace {

namespace fs = std::filesystem;

int killsWanted() {
  const char* text = std::getenv("WEIR_TEST_KILLS");
  return text != nullptr ? std::atoi(text) : 3;
}

class KillAndResume : public testing::TestWithParam<std::string> {
 protected:
  KillAndResume() { folder.write("scene.json", kStateful); }

  std::string file(const std::string& run, const std::string& ending) const {
    return folder / (run + "." + ending);
  }

  /// Resumes where there is a checkpoint.
  std::vector<std::string> arguments(const std::string& run) const {
    std::vector<std::string> all{"run", folder / "scene.json", "--device", GetParam()};
    const auto add = [&](const std::vector<std::string>& more) {
      all.insert(all.end(), more.begin(), more.end());
    };
    add({"--deterministic", "--threads", "2", "--quiet"});
    add({"--export", file(run, "vtkhdf"), "--series", file(run, "jsonl"), "--stats", file(run, "json")});
    add({"--checkpoint", file(run, "h5"), "--checkpoint-every", "7"});
    if (canMakeVideos()) add({"--video", file(run, "mp4")});
    if (fs::exists(file(run, "h5"))) add({"--resume", file(run, "h5")});
    return all;
  }

  /// True if it was killed before its end.
  bool runAndKillAfter(double seconds) const {
    std::vector<std::string> all = arguments("killed");
    all.insert(all.begin(), {"-s", "KILL", std::to_string(seconds), weirProgram()});
    ::prctl(PR_SET_CHILD_SUBREAPER, 1);  // to see the end of ffmpeg, which completes what it was given
    const ChildResult result = runChild(findProgram("timeout"), all);
    while (::waitpid(-1, nullptr, 0) > 0) {
    }
    ::prctl(PR_SET_CHILD_SUBREAPER, 0);
    EXPECT_TRUE(result.signal == SIGKILL || result.code == 0) << result.err;
    return result.signal == SIGKILL;
  }

  void expectAllReadable() const {
    const std::string checkpoint = file("killed", "h5");
    if (fs::exists(checkpoint)) {
      EXPECT_NO_THROW(Hdf5CheckpointStore().read(checkpoint));
      if (canMakeVideos()) {
        EXPECT_GE(probeVideo(file("killed", "mp4")).frames, 7);
      }
    }
    if (fs::exists(file("killed", "vtkhdf"))) expectReadable(file("killed", "vtkhdf"));
  }

  /// Every frame is there once, and in order: nearly the same picture as in the video of the other run.
  void expectSameVideos() const {
    const auto left = readVideo(file("whole", "mp4")), right = readVideo(file("killed", "mp4"));
    EXPECT_EQ(left.size(), static_cast<std::size_t>(kStatefulFrames));
    ASSERT_EQ(left.size(), right.size());
    for (std::size_t k = 0; k < left.size(); ++k) {
      double difference = 0;
      for (std::size_t i = 0; i < left[k].rgb.size(); ++i)
        difference += std::abs(int{left[k].rgb[i]} - int{right[k].rgb[i]});
      EXPECT_LT(difference / static_cast<double>(left[k].rgb.size()), 1.0) << "frame " << k;
    }
  }

  TemporaryFolder folder;
};

TEST_P(KillAndResume, EndsAsARunThatWasLeftAlone) {
  if (findProgram("timeout").empty()) GTEST_SKIP() << "the program timeout, of coreutils, is not there";
  const auto start = std::chrono::steady_clock::now();
  const ChildResult whole = runWeir(arguments("whole"));
  ASSERT_EQ(whole.code, 0) << whole.err;
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;

  std::mt19937 random(1);
  int kills = 0;
  while (kills < killsWanted()) {
    const double after = took.count() * std::uniform_real_distribution(0.05, 0.9)(random);
    if (runAndKillAfter(after)) {
      ++kills;
      SCOPED_TRACE("kill " + std::to_string(kills) + " after " + std::to_string(after) + " s");
      expectAllReadable();
    } else {
      // It came to its end: once more from the beginning.
      expectSameSeries(file("whole", "jsonl"), file("killed", "jsonl"));
      fs::remove(file("killed", "h5"));
    }
    if (HasFailure()) return;
  }
  const ChildResult resumed = runWeir(arguments("killed"));
  ASSERT_EQ(resumed.code, 0) << resumed.err;

  expectSameSeries(file("whole", "jsonl"), file("killed", "jsonl"));
  expectSameExports(file("whole", "vtkhdf"), file("killed", "vtkhdf"));
  EXPECT_EQ(expectReadable(file("killed", "vtkhdf")), static_cast<std::size_t>(kStatefulFrames));
  const Hdf5CheckpointStore store;
  const StateArrays left = store.read(file("whole", "h5")).state;
  const StateArrays right = store.read(file("killed", "h5")).state;
  for (const auto& [path, array] : left) {
    if (path.starts_with("nodes/")) {
      EXPECT_EQ(array.data, right.at(path).data) << path;
    }
  }
  const Value statistics = parseJson(readFile(file("killed", "json")), "killed");
  EXPECT_EQ(statistics.find("frames")->asInt(), kStatefulFrames - 1);
  if (canMakeVideos()) expectSameVideos();
}

WEIR_ON_EVERY_DEVICE(KillAndResume);

TEST(KilledEarly, ExportsOfNoStepAndOfOneAreReadable) {
  const TemporaryFolder folder;
  const std::string none = folder / "none.vtkhdf", one = folder / "one.vtkhdf";
  VtkHdfWriter(none, {.fields = {{"particles", 1}}}).close();
  EXPECT_EQ(expectReadable(none), 0u);
  const ChildResult run = runWeir({"run", folder.write("scene.json", kStateful), "--device", "cpu", "--quiet",
                                   "--frames", "0", "--export", one});
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(expectReadable(one), 1u);
}

/// The last write of a step is that of its time; VTK crashed where it was there and the step did not count
/// yet.
TEST(KilledEarly, ExportsWhoseLastStepHasNoTimeAreReadable) {
  const TemporaryFolder folder;
  const std::string file = folder / "run.vtkhdf";
  const ChildResult run = runWeir({"run", folder.write("scene.json", kStateful), "--device", "cpu", "--quiet",
                                   "--frames", "3", "--export", file});
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(expectReadable(file), 4u);
  {
    hdf5::File opened = hdf5::File::reopen(file);
    opened.root().group("VTKHDF").group("Steps").dataset("Values").truncate(3);
  }
  EXPECT_EQ(expectReadable(file), 3u);
}

}  // namespace
}  // namespace weir::test
