// Outputs that fail in the middle of a run: a clear error and exit code 5, what was written before is
// readable, and the last checkpoint is whole and can be gone on from.
#include <signal.h>

#include <filesystem>
#include <fstream>

#include "framework/run/checkpoint.h"
#include "plugins/vtkhdf/checkpoint_file.h"
#include "tests/plugins/outputs/written_run.h"
#include "tests/plugins/video/video_tools.h"
#include "tests/support/expect_error.h"
#include "tests/support/small_disk.h"

namespace weir::test {
namespace {

namespace fs = std::filesystem;

class OutputFailure : public testing::Test {
 protected:
  OutputFailure() { folder.write("scene.json", kStateful); }

  /// Of a run of a thousand frames, which no test waits for.
  std::vector<std::string> endless(const std::string& where, std::vector<std::string> more) const {
    std::vector<std::string> all{"run",
                                 folder / "scene.json",
                                 "--device",
                                 "cpu",
                                 "--threads",
                                 "2",
                                 "--duration",
                                 "20",
                                 "--export",
                                 where + "/run.vtkhdf",
                                 "--checkpoint",
                                 where + "/run.h5",
                                 "--checkpoint-every",
                                 "8"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }

  static std::int64_t frameOf(const std::string& checkpoint) {
    std::int64_t frame = -1;
    const Checkpoint read = Hdf5CheckpointStore().read(checkpoint);
    StateReader(read.state).in("clock").get("frame", frame);
    return frame;
  }

  /// What is in the folder can be read; the run goes on from its checkpoint in another one.
  void expectThatItGoesOn(const std::string& where, bool video) const {
    const std::int64_t frame = frameOf(where + "/run.h5");
    EXPECT_GE(frame, 8);
    EXPECT_GT(static_cast<std::int64_t>(expectReadable(where + "/run.vtkhdf")), frame);
    if (video) {
      EXPECT_GT(probeVideo(where + "/run.mp4").frames, frame);
    }
    const std::string there = folder / "there";
    fs::create_directory(there);
    for (const char* name : {"run.h5", "run.vtkhdf", "run.mp4"})
      if (fs::exists(where + "/" + name)) fs::copy(where + "/" + name, there + "/" + name);
    std::vector<std::string> more{"--resume", there + "/run.h5", "--frames", std::to_string(frame + 2)};
    if (video) more.insert(more.end(), {"--video", there + "/run.mp4"});
    const ChildResult resumed = runWeir(endless(there, more));
    EXPECT_EQ(resumed.code, 0) << resumed.err;
    EXPECT_EQ(static_cast<std::int64_t>(expectReadable(there + "/run.vtkhdf")), frame + 3);
    if (video) {
      EXPECT_EQ(probeVideo(there + "/run.mp4").frames, frame + 3);
    }
  }

  void expectAnErrorAtTheLimit(const std::string& before) const {
    std::vector<std::string> all = endless(folder.path(), {});
    all.insert(all.begin(), {"-c", before + "ulimit -f 3000; exec \"$0\" \"$@\"", weirProgram()});
    const ChildResult result = runChild("/bin/sh", all);
    EXPECT_EQ(result.code, 5) << result.err;
    EXPECT_CONTAINS(result.err, "File too large");
    EXPECT_CONTAINS(result.err, folder / "run.vtkhdf");
    expectThatItGoesOn(folder.path(), false);
  }

  TemporaryFolder folder;
};

TEST_F(OutputFailure, AFullDisk) {
  const SmallDisk disk("2m");
  if (!disk.isThere()) GTEST_SKIP() << "this user may not mount a file system";
  std::vector<std::string> more;
  if (canMakeVideos()) more = {"--video", disk / "run.mp4"};
  const ChildResult result = runWeir(endless(disk.path(), more));
  EXPECT_EQ(result.code, 5) << result.err;
  EXPECT_CONTAINS(result.err, "No space left on device");
  EXPECT_CONTAINS(result.err, disk.path() + "/run.");
  expectThatItGoesOn(disk.path(), canMakeVideos());
}

TEST_F(OutputFailure, AFileThatMayGrowNoMore) {
  expectAnErrorAtTheLimit("");  // the kernel sends SIGXFSZ
}

TEST_F(OutputFailure, AFileThatMayGrowNoMoreWithoutASignal) {
  expectAnErrorAtTheLimit("trap '' XFSZ; ");  // as where a quota is used up
}

TEST_F(OutputFailure, ARemovedFolder) {
  const std::string where = folder / "out";
  const auto runAndRemove = [&](const std::vector<std::string>& arguments) {
    fs::create_directory(where);
    ChildOptions options;
    options.onStderr = [&](int, const std::string& err) {
      std::error_code ignored;
      // A file may come while it is removed.
      for (int i = 0; i < 1000 && contains(err, "frame 0/") && fs::exists(where); ++i)
        fs::remove_all(where, ignored);
    };
    const ChildResult result = runWeir(arguments, options);
    EXPECT_EQ(result.code, 5) << result.err;
    EXPECT_CONTAINS(result.err, where + "/");
    EXPECT_FALSE(fs::exists(where));
  };
  const std::vector<std::string> scene{"run", folder / "scene.json", "--duration", "20", "--device", "cpu"};
  std::vector<std::vector<std::string>> outputs{
      {"--export", where + "/run.vtkhdf"},
      {"--images", where + "/images"},
      {"--checkpoint", where + "/run.h5", "--checkpoint-every", "2"}};
  if (canMakeVideos()) outputs.push_back({"--video", where + "/run.mp4"});
  for (const std::vector<std::string>& output : outputs) {
    SCOPED_TRACE(output[0]);
    std::vector<std::string> all = scene;
    all.insert(all.end(), output.begin(), output.end());
    runAndRemove(all);
  }
}

TEST_F(OutputFailure, AnFfmpegThatEndsInTheMiddle) {
  if (!canMakeVideos()) GTEST_SKIP() << "ffmpeg or ffprobe is not on the PATH";
  // The real one for the trial, the first part and copying; then one that takes a frame and a half.
  const std::string bin = folder / "bin";
  fs::create_directory(bin);
  std::ofstream(bin + "/ffmpeg") << "#!/bin/sh\n"
                                 << "case \"$*\" in *output_ts_offset*)\n"
                                 << "  head -c 27648 > /dev/null; echo 'the encoder broke' >&2; exit 9 ;;\n"
                                 << "esac\n"
                                 << "exec " << findProgram("ffmpeg") << " \"$@\"\n";
  fs::permissions(bin + "/ffmpeg", fs::perms::owner_all);
  ChildOptions options;
  options.environment["PATH"] = bin + ":" + std::getenv("PATH");
  const ChildResult result = runWeir(endless(folder.path(), {"--video", folder / "run.mp4"}), options);
  EXPECT_EQ(result.code, 5) << result.err;
  EXPECT_CONTAINS(result.err, "ffmpeg ended with exit code 9: the encoder broke");
  expectThatItGoesOn(folder.path(), true);
}

}  // namespace
}  // namespace weir::test
