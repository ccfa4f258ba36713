// Codecs, qualities and transparency of videos, as ffprobe and ffmpeg read them.
#include "plugins/video/video_format.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "plugins/video/growing_video.h"
#include "tests/plugins/video/sample_pictures.h"
#include "tests/plugins/video/video_tools.h"
#include "tests/support/expect_error.h"

namespace weir::test {
namespace {

using rendering::GrowingVideo;
using rendering::Picture;
using rendering::VideoCodec;
using rendering::VideoFormat;
using rendering::VideoWriter;

constexpr rendering::VideoSize kSize{96, 64, 24};

class VideoFormatTest : public testing::Test {
 protected:
  void SetUp() override {
    if (findProgram("ffmpeg").empty() || findProgram("ffprobe").empty())
      GTEST_SKIP() << "ffmpeg or ffprobe is not on the PATH";
  }
  /// Whether ffmpeg can make it; else says that the test leaves it out.
  bool isThere(const std::string& extension, VideoCodec codec) {
    try {
      VideoWriter(folder / ("probe" + extension), kSize, {.codec = codec});
      return true;
    } catch (const Error& error) {
      if (!contains(error.what(), "has no encoder for")) throw;
      std::cout << "left out: " << error.what() << "\n";
      return false;
    }
  }

  TemporaryFolder folder;
};

/// Waves that move: what encoders are made for.
Picture waves(int frame) {
  Picture picture{kSize.width, kSize.height, {}};
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x)
      for (int c = 0; c < 3; ++c) {
        const double u = 0.1 * (x + 2 * frame), v = 0.23 * y;
        const double wave = std::sin(u + 0.7 * c) * std::cos(v) + 0.5 * std::sin(3.1 * u + 1.7 * v);
        picture.rgb.push_back(static_cast<std::uint8_t>(128 + 70 * wave));
      }
  return picture;
}

double meanSquare(const Picture& a, const Picture& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.rgb.size(); ++i) sum += std::pow(double(a.rgb[i]) - double(b.rgb[i]), 2);
  return sum / static_cast<double>(a.rgb.size());
}

TEST_F(VideoFormatTest, VideosOfEveryCodecGoOn) {
  using enum VideoCodec;
  // In files that hold it but have another one by themselves.
  const std::vector<std::tuple<VideoCodec, std::string, std::string>> all{{kH264, "h264", ".mov"},
                                                                          {kVp9, "vp9", ".mkv"},
                                                                          {kAv1, "av1", ".mp4"},
                                                                          {kProRes, "prores", ".mkv"},
                                                                          {kFfv1, "ffv1", ".mkv"}};
  for (const auto& [codec, name, extension] : all) {
    SCOPED_TRACE(name + extension);
    if (!isThere(extension, codec)) continue;
    const std::string file = folder / (name + extension);
    GrowingVideo video(file, kSize, {.codec = codec});
    for (int i = 0; i < 7; ++i) {
      if (i == 4) video.save();
      const int grey = 30 + 25 * i;
      video.write(plainPicture(kSize.width, kSize.height, {grey, grey, grey}));
    }
    video.finish();
    EXPECT_EQ(probeVideo(file).codec, name);
    const std::vector<Picture> frames = readVideo(file);
    ASSERT_EQ(frames.size(), 7u);
    for (int i = 0; i < 7; ++i)
      EXPECT_NEAR(pixelOf(frames[static_cast<std::size_t>(i)], 48, 32).green, 30 + 25 * i, 3) << i;
  }
}

TEST_F(VideoFormatTest, Ffv1LosesNothing) {
  VideoWriter video(folder / "a.mkv", kSize, {.codec = VideoCodec::kFfv1, .quality = 0});
  for (std::uint32_t i = 0; i < 3; ++i) video.write(noisePicture(kSize.width, kSize.height, i));
  video.finish();
  const std::vector<Picture> frames = readVideo(folder / "a.mkv");
  ASSERT_EQ(frames.size(), 3u);
  for (std::uint32_t i = 0; i < 3; ++i)
    EXPECT_EQ(frames[i].rgb, noisePicture(kSize.width, kSize.height, i).rgb) << i;
}

TEST_F(VideoFormatTest, QualityIsPaidForInBytes) {
  for (const auto& [codec, extension] :
       {std::pair{VideoCodec::kH264, ".mp4"}, {VideoCodec::kVp9, ".webm"}, {VideoCodec::kAv1, ".mkv"}}) {
    if (!isThere(extension, codec)) continue;
    double worse = 1e9;
    std::uintmax_t smaller = 0;
    for (const int quality : {10, 50, 90}) {
      SCOPED_TRACE(std::string(codecName(codec)) + " " + std::to_string(quality));
      const std::string file = folder / ("quality" + std::string(extension));
      VideoWriter video(file, kSize, {.codec = codec, .quality = quality});
      for (int i = 0; i < 6; ++i) video.write(waves(i));
      video.finish();
      const double loss = meanSquare(readVideo(file).at(5), waves(5));
      EXPECT_LT(loss, 0.7 * worse);
      EXPECT_GT(std::filesystem::file_size(file), smaller);
      worse = loss;
      smaller = std::filesystem::file_size(file);
    }
  }
}

TEST_F(VideoFormatTest, TransparentVideosKeepTheirOpacity) {
  Picture picture = plainPicture(kSize.width, kSize.height, {200, 40, 60});
  picture.alpha.assign(picture.rgb.size() / 3, 0);
  std::fill(picture.alpha.begin() + static_cast<std::ptrdiff_t>(picture.alpha.size() / 2),
            picture.alpha.end(), std::uint8_t{255});
  for (const auto& [codec, extension] :
       {std::pair{VideoCodec::kProRes, ".mov"}, {VideoCodec::kVp9, ".webm"}, {VideoCodec::kFfv1, ".mkv"}}) {
    SCOPED_TRACE(extension);
    const std::string file = folder / ("clear" + std::string(extension));
    VideoWriter video(file, kSize, {.codec = codec, .alpha = true});
    for (int i = 0; i < 3; ++i) video.write(picture);
    video.finish();
    std::vector<std::string> arguments{"-v", "error"};
    if (codec == VideoCodec::kVp9) arguments.insert(arguments.end(), {"-c:v", "libvpx-vp9"});
    for (const std::string& more : {std::string("-i"), file, std::string("-f"), std::string("rawvideo"),
                                    std::string("-pix_fmt"), std::string("rgba"), file + ".rgba"})
      arguments.push_back(more);
    EXPECT_EQ(runChild(findProgram("ffmpeg"), arguments).err, "");
    const std::string bytes = readFile(file + ".rgba");
    ASSERT_EQ(bytes.size(), 3u * 4u * picture.alpha.size());
    const auto byteAt = [&](int x, int y, int c) {
      return static_cast<std::uint8_t>(
          bytes[4 * static_cast<std::size_t>(y * kSize.width + x) + static_cast<std::size_t>(c)]);
    };
    EXPECT_NEAR(byteAt(48, 10, 3), 0, 4);
    EXPECT_NEAR(byteAt(48, 54, 3), 255, 4);
    EXPECT_NEAR(byteAt(48, 54, 0), 200, 6);
  }
}

TEST_F(VideoFormatTest, SaysWhatAFileCanHold) {
  const auto errorFor = [&](const std::string& name, const VideoFormat& format) {
    const Error error = errorOf([&] { VideoWriter video(folder / name, kSize, format); });
    EXPECT_EQ(error.kind(), ErrorKind::kScene);
    return std::string(error.what());
  };
  EXPECT_CONTAINS(errorFor("a.mp4", {.codec = VideoCodec::kFfv1}), "a .mp4 file cannot hold FFV1");
  EXPECT_CONTAINS(errorFor("a.mp4", {.codec = VideoCodec::kFfv1}), "H.264, VP9, AV1 in .mp4");
  EXPECT_CONTAINS(errorFor("a.mp4", {.codec = VideoCodec::kFfv1}), "ends in .mkv");
  EXPECT_CONTAINS(errorFor("a.gif", {.codec = VideoCodec::kAv1}), "no codec but its own in .gif");
  EXPECT_CONTAINS(errorFor("a.mp4", {.alpha = true}), "a .mp4 file of H.264 cannot be transparent");
  EXPECT_CONTAINS(errorFor("a.gif", {.alpha = true}), "a .gif file cannot be transparent");
}

TEST_F(VideoFormatTest, NamesTheCodecsThatFfmpegHas) {
  const std::string real = findProgram("ffmpeg");
  const std::string program =
      folder.write("ffmpeg",
                   "#!/bin/sh\ncase \"$*\" in *av1*) exit 1;; *-encoders*)\n"
                   "echo ' V....D libx264              libx264 H.264 (codec h264)'\n"
                   "echo ' VFS... prores_ks            Apple ProRes (codec prores)'; exit 0;; esac\nexec " +
                       real + " \"$@\"\n");
  std::filesystem::permissions(program, std::filesystem::perms::owner_all);
  const PathVariable path(folder.path() + ":/usr/bin:/bin");
  const Error error =
      errorOf([&] { VideoWriter video(folder / "a.mkv", kSize, {.codec = VideoCodec::kAv1}); });
  EXPECT_EQ(error.kind(), ErrorKind::kIo);
  EXPECT_CONTAINS(error.what(), "no encoder for AV1 (libsvtav1 or libaom-av1)");
  EXPECT_CONTAINS(error.what(), "H.264, ProRes, for which it has encoders");
}

TEST_F(VideoFormatTest, GoesOnWithItsOwnCodecAndRateOnly) {
  const std::string file = folder / "a.mkv";
  GrowingVideo video(file, kSize, {.codec = VideoCodec::kFfv1});
  video.write(waves(0));
  video.save();
  const rendering::VideoState saved = video.state();
  EXPECT_CONTAINS(errorOf([&] { GrowingVideo(file, kSize, {.codec = VideoCodec::kVp9}, saved); }).what(),
                  "begun with the encoder 'ffv1', which does not make VP9");
  EXPECT_CONTAINS(errorOf([&] {
                    GrowingVideo(file, {96, 64, 30}, {.codec = VideoCodec::kFfv1}, saved);
                  }).what(),
                  "24 frames a second cannot be gone on with at 30");
}

}  // namespace
}  // namespace weir::test
