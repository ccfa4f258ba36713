// Videos that are gone on with: every frame once, in order, and at its time, however often the run was cut.
#include "plugins/video/growing_video.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "plugins/video/video_writer.h"
#include "tests/plugins/video/sample_pictures.h"
#include "tests/plugins/video/video_tools.h"
#include "tests/support/expect_error.h"

namespace weir::test {
namespace {

using rendering::GrowingVideo;
using rendering::VideoState;

constexpr double kRate = 24;
constexpr int kLevels = 6;  // of grey between two frames

class GrowingVideoTest : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    if (findProgram("ffmpeg").empty() || findProgram("ffprobe").empty())
      GTEST_SKIP() << "ffmpeg or ffprobe is not on the PATH";
  }

  /// Each frame is of another grey.
  static void show(GrowingVideo& video, int first, int end) {
    for (int i = first; i < end; ++i) {
      const int grey = 20 + kLevels * i;
      video.write(plainPicture(64, 48, {grey, grey, grey}));
    }
  }

  void expectFrames(int count) const {
    const auto frames = readVideo(file);
    ASSERT_EQ(frames.size(), static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i)
      EXPECT_NEAR(pixelOf(frames[static_cast<std::size_t>(i)], 32, 24).green, 20 + kLevels * i, 2) << i;
    const ChildResult times = runChild(
        findProgram("ffprobe"),
        {"-v", "error", "-select_streams", "v", "-of", "csv=p=0", "-show_entries", "frame=pts_time", file});
    std::istringstream lines(times.out);
    int i = 0;
    for (std::string line; std::getline(lines, line);) {
      if (line.empty()) continue;
      // Matroska counts in milliseconds; GIF in hundredths of a second, and a joint may add one.
      const double unit = GetParam() == ".mp4" ? 1e-4 : GetParam() == ".gif" ? 1.1e-2 : 1.6e-3;
      EXPECT_NEAR(std::atof(line.c_str()), i / kRate, unit) << i;
      ++i;
    }
    EXPECT_EQ(i, count);
    if (GetParam() != ".gif") return;
    const std::string bytes = readFile(file);
    EXPECT_EQ(bytes.find("GIF89a", 1), std::string::npos);  // where browsers would stop
  }

  std::size_t filesInFolder() const {
    std::size_t files = 0;
    for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder.path())) ++files;
    return files;
  }

  TemporaryFolder folder;
  std::string file = folder / ("it's a run" + GetParam());
};

TEST_P(GrowingVideoTest, IsGoneOnWithAtTheCheckpoint) {
  VideoState saved;
  {
    GrowingVideo video(file, {64, 48, kRate});
    show(video, 0, 5);
    video.save();
    saved = video.state();
    show(video, 5, 9);
    video.save();
    show(video, 9, 12);
  }
  GrowingVideo resumed(file, {64, 48, kRate}, {}, saved);
  expectFrames(5);
  show(resumed, 5, 11);
  resumed.finish();
  expectFrames(11);
  EXPECT_EQ(filesInFolder(), 1u);
}

TEST_P(GrowingVideoTest, LeavesOutWhatAPowerCutDamaged) {
  VideoState saved;
  {
    GrowingVideo video(file, {64, 48, kRate});
    show(video, 0, 3);
    video.save();
    show(video, 3, 6);
    video.save();
    saved = video.state();
  }
  const std::string grown = rendering::growingPlace(file);
  const std::string begin = readFile(grown).substr(0, 700);
  std::ofstream(grown, std::ios::binary | std::ios::app) << std::string(1000, '\0') << begin << "moofmdat";
  for (const char* left : {".part", ".part2"})  // by a run that was killed while it copied
    std::ofstream(folder / ("it's a run" + std::string(left) + GetParam())) << "half a video";
  GrowingVideo resumed(file, {64, 48, kRate}, {}, saved);
  show(resumed, 6, 9);
  resumed.finish();
  expectFrames(9);
  EXPECT_EQ(filesInFolder(), 1u);
}

// Also where a checkpoint of an older version says nothing of the file.
TEST_P(GrowingVideoTest, IsGoneOnWithWhenItWasFinished) {
  for (const bool known : {true, false}) {
    GrowingVideo video(file, {64, 48, kRate});
    show(video, 0, 3);
    video.save();
    show(video, 3, 5);
    video.save();
    VideoState saved = video.state();
    show(video, 5, 9);
    video.finish();
    expectFrames(9);
    if (!known) saved.bytes = saved.mark = 0;
    GrowingVideo resumed(file, {64, 48, kRate}, {}, saved);
    show(resumed, 5, 8);
    resumed.finish();
    expectFrames(8);
    EXPECT_EQ(filesInFolder(), 1u);
  }
}

TEST_P(GrowingVideoTest, KeepsWhatWasSavedWhereTheEncoderFails) {
  for (const int saves : {1, 2}) {
    GrowingVideo video(file, {64, 48, kRate});
    for (int i = 0; i < saves; ++i) {
      show(video, 4 * i, 4 * i + 4);
      video.save();
    }
    const FfmpegWithout fake("output_ts_offset");
    EXPECT_CONTAINS(errorOf([&] {
                      show(video, 4 * saves, 4 * saves + 3);
                      video.finish();
                    }).what(),
                    "Unknown output_ts_offset");
    EXPECT_CONTAINS(errorOf([&] { video.finish(); }).what(), "Unknown output_ts_offset");
    const PathVariable path("/usr/local/bin:/usr/bin:/bin");
    expectFrames(4 * saves);
    EXPECT_EQ(filesInFolder(), 1u);
  }
}

INSTANTIATE_TEST_SUITE_P(Containers, GrowingVideoTest, testing::ValuesIn(rendering::videoExtensions()),
                         [](const auto& tested) { return tested.param.substr(1); });

TEST(GrowingGif, GoesOnWhereAFrameTakesAHundredthOfASecond) {
  if (findProgram("ffmpeg").empty() || findProgram("ffprobe").empty())
    GTEST_SKIP() << "ffmpeg or ffprobe is not on the PATH";
  const TemporaryFolder folder;
  const std::string file = folder / "a.gif";
  GrowingVideo video(file, {64, 48, 100});
  for (int i = 0; i < 9; ++i) {
    if (i == 4) video.save();
    video.write(plainPicture(64, 48, {20 * i, 20 * i, 20 * i}));
  }
  video.finish();
  EXPECT_EQ(probeVideo(file).frames, 9);
}

class GrowingVideoMp4 : public GrowingVideoTest {};

TEST_P(GrowingVideoMp4, IsWholeAfterEverySave) {
  GrowingVideo video(file, {64, 48, kRate});
  show(video, 0, 7);
  video.save();
  expectFrames(7);
  video.save();
  show(video, 7, 8);
  video.save();
  expectFrames(8);
  EXPECT_EQ(video.state().frames, 8);
  show(video, 8, 21);
  EXPECT_TRUE(contains(readFile(file), "moof"));
  video.finish();
  expectFrames(21);
  EXPECT_FALSE(contains(readFile(file), "moof"));  // as players that know no fragments expect it
  EXPECT_EQ(filesInFolder(), 1u);
}

TEST_P(GrowingVideoMp4, WithoutMoreFramesEndsAtTheCheckpoint) {
  GrowingVideo video(file, {64, 48, kRate});
  show(video, 0, 3);
  video.save();
  const VideoState saved = video.state();
  show(video, 3, 6);
  video.finish();
  GrowingVideo(file, {64, 48, kRate}, {}, saved).finish();
  expectFrames(3);
}

TEST_P(GrowingVideoMp4, SayWhyItCannotBeGoneOnWith) {
  const VideoState saved{.frames = 4, .size = {64, 48, kRate}, .encoder = "libx264"};
  const auto resume = [&](int width) { GrowingVideo video(file, {width, 48, kRate}, {}, saved); };
  EXPECT_CONTAINS(errorOf([&] { resume(64); }).what(), "there is no such video");
  EXPECT_CONTAINS(errorOf([&] { resume(32); }).what(),
                  "64 x 48 cannot be gone on with in pictures of 32 x 48");
  folder.write(std::filesystem::path(file).filename(), "no video");
  EXPECT_CONTAINS(errorOf([&] { resume(64); }).what(), "not a video that ffmpeg can read");
  std::filesystem::remove(file);
  GrowingVideo video(file, {64, 48, kRate});
  show(video, 0, 3);
  video.finish();
  const Error error = errorOf([&] { resume(64); });
  EXPECT_EQ(error.kind(), ErrorKind::kIo);
  EXPECT_CONTAINS(error.what(), "holds 3 frames, but the checkpoint was made when it had 4");
  expectFrames(3);
}

INSTANTIATE_TEST_SUITE_P(Mp4, GrowingVideoMp4, testing::Values(".mp4"));

}  // namespace
}  // namespace weir::test
