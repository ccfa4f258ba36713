#include "plugins/video/video_writer.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "framework/base/check.h"
#include "tests/plugins/video/sample_pictures.h"
#include "tests/plugins/video/video_tools.h"
#include "tests/support/expect_error.h"

namespace weir::test {
namespace {

using rendering::Picture;
using rendering::VideoWriter;

class VideoWriterTest : public testing::Test {
 protected:
  void SetUp() override {
    if (findProgram("ffmpeg").empty() || findProgram("ffprobe").empty())
      GTEST_SKIP() << "ffmpeg or ffprobe is not on the PATH";
  }
  bool folderIsEmpty() const { return std::filesystem::is_empty(folder.path()); }

  TemporaryFolder folder;
};

void expectNear(Rgb found, Rgb expected, int tolerance) {
  EXPECT_NEAR(found.red, expected.red, tolerance);
  EXPECT_NEAR(found.green, expected.green, tolerance);
  EXPECT_NEAR(found.blue, expected.blue, tolerance);
}

Picture withRight(Picture picture, Rgb color) {
  for (int y = 0; y < picture.height; ++y)
    for (int x = picture.width / 2; x < picture.width; ++x) {
      std::uint8_t* pixel = &picture.rgb[3 * static_cast<std::size_t>(y * picture.width + x)];
      pixel[0] = static_cast<std::uint8_t>(color.red);
      pixel[1] = static_cast<std::uint8_t>(color.green);
      pixel[2] = static_cast<std::uint8_t>(color.blue);
    }
  return picture;
}

TEST_F(VideoWriterTest, GivesBackFramesInOrderWithTheirColors) {
  const std::vector<Rgb> colors{{255, 0, 0},     {0, 255, 0}, {0, 0, 255},
                                {255, 255, 255}, {0, 0, 0},   {200, 120, 40}};
  for (const std::string& extension : rendering::videoExtensions()) {
    SCOPED_TRACE(extension);
    const std::string file = folder / "run" + extension;
    VideoWriter video(file, {64, 48, 24});
    for (const Rgb& color : colors) video.write(withRight(plainPicture(64, 48, color), {128, 128, 128}));
    video.finish();
    EXPECT_EQ(video.frameCount(), 6);
    const VideoInfo info = probeVideo(file);
    EXPECT_EQ(info.width, 64);
    EXPECT_EQ(info.height, 48);
    const bool editing = extension == ".mov", palette = extension == ".gif";
    if (palette) {  // which counts hundredths of a second
      int frames = 0, seconds = 1;
      ASSERT_EQ(std::sscanf(info.frameRate.c_str(), "%d/%d", &frames, &seconds), 2) << info.frameRate;
      EXPECT_NEAR(static_cast<double>(frames) / seconds, 24, 1);
    } else {
      EXPECT_EQ(info.frameRate, "24/1");
    }
    EXPECT_EQ(info.codec, extension == ".webm" ? "vp9" : editing ? "prores" : palette ? "gif" : "h264");
    if (!palette) {
      EXPECT_EQ(info.pixelFormat, editing ? "yuv422p10le" : "yuv420p");
      EXPECT_EQ(info.colorSpace, "bt709");
    }
    const std::vector<Picture> frames = readVideo(file);
    ASSERT_EQ(frames.size(), colors.size());
    for (std::size_t i = 0; i < colors.size(); ++i) {
      SCOPED_TRACE(i);
      expectNear(pixelOf(frames[i], 16, 24), colors[i], 6);
      expectNear(pixelOf(frames[i], 48, 24), {128, 128, 128}, 6);
    }
  }
}

TEST_F(VideoWriterTest, HasTheTopRowFirst) {
  Picture picture = plainPicture(32, 32, {255, 255, 255});
  std::fill(picture.rgb.begin(), picture.rgb.begin() + static_cast<std::ptrdiff_t>(picture.rgb.size() / 2),
            std::uint8_t{0});
  VideoWriter video(folder / "a.mp4", {32, 32, 30});
  video.write(picture);
  video.finish();
  const std::vector<Picture> frames = readVideo(folder / "a.mp4");
  ASSERT_EQ(frames.size(), 1u);
  expectNear(pixelOf(frames[0], 16, 4), {0, 0, 0}, 4);
  expectNear(pixelOf(frames[0], 16, 28), {255, 255, 255}, 4);
}

TEST_F(VideoWriterTest, RepeatsTheLastColumnAndRowOfOddSizes) {
  for (const auto& [width, height] : {std::pair{33, 21}, {33, 20}, {32, 21}}) {
    Picture picture = withRight(plainPicture(width, height, {0, 0, 0}), {255, 255, 255});
    VideoWriter video(folder / "a.mp4", {width, height, 30});
    video.write(picture);
    video.write(picture);
    video.finish();
    const std::vector<Picture> frames = readVideo(folder / "a.mp4");
    ASSERT_EQ(frames.size(), 2u);
    EXPECT_EQ(frames[1].width, width + width % 2);
    EXPECT_EQ(frames[1].height, height + height % 2);
    expectNear(pixelOf(frames[1], 4, frames[1].height - 1), {0, 0, 0}, 6);
    expectNear(pixelOf(frames[1], frames[1].width - 1, frames[1].height - 1), {255, 255, 255}, 6);
  }
}

TEST_F(VideoWriterTest, TakesFrameRatesThatAreNotWhole) {
  for (const auto& [rate, shown] : {std::pair{29.97, "2997/100"}, {0.5, "1/2"}, {1000.0, "1000/1"}}) {
    VideoWriter video(folder / "a.mp4", {32, 32, rate});
    for (int i = 0; i < 5; ++i) video.write(noisePicture(32, 32, static_cast<std::uint32_t>(i)));
    video.finish();
    const VideoInfo info = probeVideo(folder / "a.mp4");
    EXPECT_EQ(info.frameRate, shown);
    EXPECT_EQ(info.frames, 5);
  }
}

TEST_F(VideoWriterTest, KeepsManyFramesThatComeFasterThanTheyAreEncoded) {
  VideoWriter video(folder / "a.mp4", {320, 240, 60});
  for (std::uint32_t i = 0; i < 60; ++i) video.write(noisePicture(320, 240, i % 7));
  video.finish();
  EXPECT_EQ(probeVideo(folder / "a.mp4").frames, 60);
}

TEST_F(VideoWriterTest, HasAPlaceOfItsOwnUntilItIsComplete) {
  folder.write("a.mp4", "old");
  VideoWriter video(folder / "a.mp4", {32, 32, 30});
  video.write(plainPicture(32, 32, {1, 2, 3}));
  EXPECT_EQ(readFile(folder / "a.mp4"), "old");
  EXPECT_TRUE(std::filesystem::exists(folder / "a.part.mp4"));
  VideoWriter other(folder / "a.mp4", {32, 32, 30});
  EXPECT_TRUE(std::filesystem::exists(folder / "a.part2.mp4"));
  video.finish();
  video.finish();
  EXPECT_EQ(probeVideo(folder / "a.mp4").frames, 1);
  EXPECT_FALSE(std::filesystem::exists(folder / "a.part.mp4"));
  EXPECT_THROW(video.write(plainPicture(32, 32, {})), InternalError);
}

TEST_F(VideoWriterTest, LeavesNothingBehindWithoutFinish) {
  {
    VideoWriter video(folder / "a.mp4", {320, 240, 30});
    for (std::uint32_t i = 0; i < 9; ++i) video.write(noisePicture(320, 240, i));
  }
  EXPECT_TRUE(folderIsEmpty());
}

TEST_F(VideoWriterTest, IsNoVideoWithoutAFrame) {
  const std::string old = folder.write("a.mp4", "old");
  VideoWriter video(old, {32, 32, 30});
  video.finish();
  EXPECT_EQ(readFile(old), "old");
  EXPECT_FALSE(std::filesystem::exists(folder / "a.part.mp4"));
}

TEST_F(VideoWriterTest, TakesFileNamesThatOtherProgramsMayMisread) {
  for (const std::string name : {"-y.mp4", "http:a b.mp4", "frame%03d.mp4", "dämme'$(x)\\.mp4"}) {
    SCOPED_TRACE(name);
    VideoWriter video(folder / name, {32, 32, 30});
    video.write(plainPicture(32, 32, {}));
    video.finish();
    EXPECT_TRUE(std::filesystem::file_size(folder / name) > 0);
  }
}

TEST_F(VideoWriterTest, SaysWhatIsWrongWithThePath) {
  const auto errorAt = [](const std::string& file) {
    const Error error = errorOf([&] { VideoWriter video(file, {32, 32, 30}); });
    EXPECT_EQ(error.kind(), ErrorKind::kIo);
    EXPECT_EQ(error.location().file, file);
    return std::string(error.what());
  };
  EXPECT_CONTAINS(errorAt(folder / "a.avi"), ".mp4, .mkv, .webm, .mov, .gif");
  EXPECT_CONTAINS(errorAt(folder / "no/a.mp4"), "there is no folder");
  std::filesystem::create_directory(folder / "b.mp4");
  EXPECT_CONTAINS(errorAt(folder / "b.mp4"), "it is a folder");
  EXPECT_EQ(errorOf([] { VideoWriter video("/proc/a.mp4", {32, 32, 30}); }).kind(), ErrorKind::kIo);
}

TEST_F(VideoWriterTest, RejectsPicturesOfAnotherSize) {
  VideoWriter video(folder / "a.mp4", {32, 32, 30});
  EXPECT_THROW(video.write(plainPicture(32, 30, {})), InternalError);
  Picture picture = plainPicture(32, 32, {});
  picture.rgb.pop_back();
  EXPECT_THROW(video.write(picture), InternalError);
}

TEST_F(VideoWriterTest, FallsBackToTheEncoderThatIsThere) {
  const FfmpegWithout fake("libx264");
  VideoWriter video(folder / "a.mp4", {64, 64, 30});
  EXPECT_EQ(video.encoder(), "mpeg4");
  for (int i = 0; i < 3; ++i) video.write(plainPicture(64, 64, {0, 200, 0}));
  video.finish();
  const PathVariable path("/usr/local/bin:/usr/bin:/bin");
  EXPECT_EQ(probeVideo(folder / "a.mp4").codec, "mpeg4");
  EXPECT_EQ(readVideo(folder / "a.mp4").size(), 3u);
}

TEST_F(VideoWriterTest, SaysSoWhereNoEncoderWorks) {
  const FfmpegWithout fake("libvpx-vp9");
  const Error error = errorOf([&] { VideoWriter video(folder / "a.webm", {64, 64, 30}); });
  EXPECT_EQ(error.kind(), ErrorKind::kIo);
  EXPECT_CONTAINS(error.what(), "ffmpeg ended with exit code 1: Unknown libvpx-vp9");
  EXPECT_TRUE(folderIsEmpty());
}

}  // namespace
}  // namespace weir::test
