// Videos that cannot be made: no ffmpeg, an ffmpeg that fails, a full disk.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <thread>

#include "plugins/video/video_writer.h"
#include "tests/plugins/video/sample_pictures.h"
#include "tests/plugins/video/video_tools.h"
#include "tests/support/expect_error.h"
#include "tests/support/small_disk.h"

namespace weir::test {
namespace {

using rendering::VideoWriter;

/// Makes a video of 32 by 32 pixels, or throws.
void makeVideo(const std::string& file, int frames) {
  VideoWriter video(file, {32, 32, 30});
  for (int i = 0; i < frames; ++i) video.write(noisePicture(32, 32, static_cast<std::uint32_t>(i)));
  video.finish();
}

TEST(VideoFailure, SaysThatFfmpegIsMissingAndWhatToDo) {
  const TemporaryFolder folder;
  const PathVariable path(folder.path());
  const Error error = errorOf([&] { VideoWriter video(folder / "a.mp4", {32, 32, 30}); });
  EXPECT_EQ(error.kind(), ErrorKind::kIo);
  EXPECT_EQ(error.location().file, folder / "a.mp4");
  EXPECT_CONTAINS(error.what(), "the program ffmpeg, which makes videos, is not on the PATH");
  EXPECT_CONTAINS(error.hint(), "apt install ffmpeg");
  EXPECT_CONTAINS(error.hint(), "--images");
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(VideoFailure, SaysThatFfmpegCannotBeRun) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "ffmpeg");
  const PathVariable path(folder.path());
  EXPECT_CONTAINS(errorOf([&] { makeVideo(folder / "a.mp4", 1); }).what(),
                  "cannot be started: Permission denied");
}

TEST(VideoFailure, QuotesFfmpegWhenItDiesInTheMiddle) {
  const TemporaryFolder folder;
  // A broken pipe must not end this program even where nobody ignores the signal.
  ::signal(SIGPIPE, SIG_DFL);
  const FakeFfmpeg fake(
      "head -c 20000 > /dev/null; echo one >&2; printf 'two \\033[31m red\\r\\n' >&2; exit 3");
  const Error error = errorOf([&] { makeVideo(folder / "a.mp4", 100000); });
  EXPECT_EQ(error.kind(), ErrorKind::kIo);
  EXPECT_EQ(error.location().file, folder / "a.mp4");
  EXPECT_CONTAINS(error.what(), "ffmpeg ended with exit code 3: one; two ");
  EXPECT_FALSE(contains(error.what(), "\033"));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(VideoFailure, StaysFailed) {
  const TemporaryFolder folder;
  const FakeFfmpeg fake("cat > /dev/null; exit 7");
  VideoWriter video(folder / "a.mp4", {32, 32, 30});
  video.write(plainPicture(32, 32, {}));
  EXPECT_CONTAINS(errorOf([&] { video.finish(); }).what(),
                  "ffmpeg ended with exit code 7: it gave no reason");
  EXPECT_CONTAINS(errorOf([&] { video.finish(); }).what(), "ffmpeg ended with exit code 7");
  EXPECT_FALSE(std::filesystem::exists(folder / "a.mp4"));
}

TEST(VideoFailure, NamesTheSignalThatEndedFfmpeg) {
  const TemporaryFolder folder;
  const FakeFfmpeg fake("kill -11 $$");
  EXPECT_CONTAINS(errorOf([&] { makeVideo(folder / "a.mp4", 1); }).what(), "ffmpeg was ended by signal 11");
}

TEST(VideoFailure, IsNotHeldUpByAnFfmpegThatWritesMuch) {
  const TemporaryFolder folder;
  const FakeFfmpeg fake(
      "yes 'a long story' | head -c 5000000 >&2; cat > /dev/null; "
      "yes 'to the end' | head -c 5000000 >&2; exit 1");
  const std::string error = errorOf([&] { makeVideo(folder / "a.mp4", 200); }).what();
  EXPECT_CONTAINS(error, "to the end");
  EXPECT_LT(error.size(), 1500u);
}

TEST(VideoFailure, IsNotHeldUpByAProgramThatFfmpegLeftBehind) {
  const TemporaryFolder folder;
  const FakeFfmpeg fake("cat > /dev/null; sleep 1000 & exit 2");
  EXPECT_CONTAINS(errorOf([&] { makeVideo(folder / "a.mp4", 2); }).what(), "exit code 2");
}

TEST(VideoFailure, StopsAnFfmpegThatHangs) {
  const TemporaryFolder folder;
  const FakeFfmpeg fake("echo $$ > \"$FOLDER/pid\"; sleep 1000; exit 0");
  std::string pid;
  {
    VideoWriter video(folder / "a.mp4", {320, 240, 30});
    for (std::uint32_t i = 0; i < 4; ++i) video.write(noisePicture(320, 240, i));
    while ((pid = readFile(fake / "pid")).empty()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  EXPECT_EQ(::kill(std::stoi(pid), 0), -1);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(VideoFailure, KeepsFfmpegOutOfTheTerminalsGroup) {
  const TemporaryFolder folder;
  const FakeFfmpeg fake("cut -d' ' -f1,5 /proc/$$/stat > \"$FOLDER/group\"; cat > /dev/null; " +
                        writesFrames(1) + "exit 0");
  makeVideo(folder / "a.mp4", 1);
  const std::string ids = readFile(fake / "group");
  const int pid = std::stoi(ids), group = std::stoi(ids.substr(ids.find(' ')));
  EXPECT_EQ(group, pid);
  EXPECT_NE(group, ::getpgrp());
}

/// Sets the limit on ffmpeg, and takes it away at the end.
class FfmpegLimit {
 public:
  explicit FfmpegLimit(const char* seconds) { ::setenv("WEIR_FFMPEG_LIMIT", seconds, 1); }
  ~FfmpegLimit() { ::unsetenv("WEIR_FFMPEG_LIMIT"); }
  FfmpegLimit(const FfmpegLimit&) = delete;
  FfmpegLimit& operator=(const FfmpegLimit&) = delete;
};

/// Enough that a socket does not hold them.
constexpr int kManyFrames = 1000;

void expectTooSlow(const Error& error, const std::string& what) {
  EXPECT_EQ(error.kind(), ErrorKind::kIo);
  EXPECT_CONTAINS(error.what(), "ffmpeg " + what);
  EXPECT_CONTAINS(error.hint(), "WEIR_FFMPEG_LIMIT");
}

TEST(VideoFailure, EndsAnFfmpegThatTakesNoFrame) {
  const TemporaryFolder folder;
  const FfmpegLimit limit("1");
  for (const std::string before : {"", "head -c 100000 > /dev/null; "}) {
    const FakeFfmpeg fake(before + "echo stuck >&2; sleep 1000");
    const Error error = errorOf([&] { makeVideo(folder / "a.mp4", kManyFrames); });
    expectTooSlow(error, "took no frame for 1 s: stuck");
    EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  }
}

TEST(VideoFailure, EndsAnFfmpegThatDoesNotEnd) {
  const TemporaryFolder folder;
  const FfmpegLimit limit("0.7");
  const FakeFfmpeg fake("cat > /dev/null; sleep 1000");
  expectTooSlow(errorOf([&] { makeVideo(folder / "a.mp4", 3); }), "did not end for 1.4 s");
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(VideoFailure, EndsAnFfmpegThatHangsInTheTrial) {
  const TemporaryFolder folder;
  const FfmpegLimit limit("0.7");
  const FakeFfmpeg fake("exit 1", "sleep 1000");
  expectTooSlow(errorOf([&] { VideoWriter video(folder / "a.mp4", {32, 32, 30}); }), "did not end for 1.4 s");
}

TEST(VideoFailure, SaysWhatTheLimitMayBe) {
  const TemporaryFolder folder;
  for (const char* wrong : {"", "soon", "0", "-1", "nan", "1e9", "5 s"}) {
    const FfmpegLimit limit(wrong);
    const Error error = errorOf([&] { makeVideo(folder / "a.mp4", 1); });
    EXPECT_CONTAINS(error.what(), "WEIR_FFMPEG_LIMIT is '" + std::string(wrong) + "'");
    EXPECT_CONTAINS(error.allowed(), "above 0");
  }
}

TEST(VideoFailure, IsAnEmptyVideo) {
  const TemporaryFolder folder;
  const FakeFfmpeg fake("cat > /dev/null; exit 0");
  EXPECT_CONTAINS(errorOf([&] { makeVideo(folder / "a.mp4", 3); }).what(), "the video is empty");
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(VideoFailure, IsAVideoWithTooFewFrames) {
  const TemporaryFolder folder;
  const FakeFfmpeg fake("cat > /dev/null; " + writesFrames(2) + "exit 0");
  EXPECT_CONTAINS(errorOf([&] { makeVideo(folder / "a.mp4", 3); }).what(), "has written 2 of 3 frames");
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

/// In a child process: hands frames over and is killed while ffmpeg still takes them.
[[noreturn]] void writeAndDie(const std::string& file, int frames) {
  VideoWriter video(file, {1280, 720, 30});
  for (int i = 0; i < frames; ++i) video.write(noisePicture(1280, 720, 1));
  ::kill(::getpid(), SIGKILL);
  std::abort();
}

TEST(VideoFailure, LeavesTheFramesSoFarWhereThisProgramIsKilled) {
  if (findProgram("ffmpeg").empty() || findProgram("ffprobe").empty())
    GTEST_SKIP() << "ffmpeg or ffprobe is not on the PATH";
  constexpr int kFrames = 10, kMaxWaiting = 5;
  const TemporaryFolder folder;
  ::prctl(PR_SET_CHILD_SUBREAPER, 1);  // to see ffmpeg's end, too
  const pid_t child = ::fork();
  if (child == 0) writeAndDie(folder / "a.mp4", kFrames);
  while (::waitpid(-1, nullptr, 0) > 0) {
  }
  ::prctl(PR_SET_CHILD_SUBREAPER, 0);
  EXPECT_GE(probeVideo(folder / "a.part.mp4").frames, kFrames - kMaxWaiting);
}

class FullDiskTest : public testing::Test {
 protected:
  void SetUp() override {
    if (findProgram("ffmpeg").empty() || findProgram("ffprobe").empty())
      GTEST_SKIP() << "ffmpeg or ffprobe is not on the PATH";
    if (!SmallDisk("64k").isThere()) GTEST_SKIP() << "this user cannot mount a small disk";
  }
};

TEST_F(FullDiskTest, IsReportedWithFfmpegsReason) {
  const SmallDisk disk("64k");
  const Error error = errorOf([&] { makeVideo(disk / "a.mp4", 500); });
  EXPECT_EQ(error.kind(), ErrorKind::kIo);
  EXPECT_EQ(error.location().file, disk / "a.mp4");
  EXPECT_CONTAINS(error.what(), "No space left on device");
  EXPECT_TRUE(std::filesystem::is_empty(disk.path()));
}

TEST_F(FullDiskTest, IsReportedBeforeTheFirstFrame) {
  const SmallDisk disk("4k");
  std::ofstream(disk / "filler") << std::string(4096, 'x');
  EXPECT_CONTAINS(errorOf([&] {
                    VideoWriter video(disk / "a.mp4", {32, 32, 30});
                  }).what(),
                  "No space left on device");
}

// ffmpeg may notice only while it completes the file, and must not call that a success.
TEST_F(FullDiskTest, NeverGivesAVideoWithFramesMissing) {
  constexpr int kFrames = 20;
  const TemporaryFolder folder;
  for (const std::string& extension : rendering::videoExtensions()) {
    makeVideo(folder / "a" + extension, kFrames);
    const std::size_t size = std::filesystem::file_size(folder / "a" + extension);
    int failed = 0, complete = 0;
    for (std::size_t room = 4096; room < size + 12288; room += 4096) {
      const SmallDisk disk(std::to_string(room));
      const std::string file = disk / "a" + extension;
      try {
        makeVideo(file, kFrames);
        EXPECT_EQ(probeVideo(file).frames, kFrames) << room;
        ++complete;
      } catch (const Error& error) {
        EXPECT_CONTAINS(error.what(), "No space left on device");
        EXPECT_FALSE(std::filesystem::exists(file));
        ++failed;
      }
    }
    EXPECT_GT(failed, 0) << extension;
    EXPECT_GT(complete, 0) << extension;
  }
}

}  // namespace
}  // namespace weir::test
