#include "plugins/rendering/output/video_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <span>
#include <system_error>
#include <utility>

#include "framework/base/check.h"
#include "plugins/rendering/output/ffmpeg.h"
#include "plugins/rendering/output/piped_program.h"

namespace weir::rendering {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kLongestQueue = 4;

/// What the file's extension stands for.
struct Container {
  std::string extension;
  std::vector<std::string> options;
  std::vector<VideoEncoder> encoders;  ///< the best one first
};

const std::vector<Container>& containers() {
  // Nearly without visible loss, and fast enough not to slow the simulation down. Some distributions build
  // ffmpeg without x264; its own MPEG-4 encoder is always there.
  // No frames that depend on later ones (-bf 0): so videos can be cut and joined at any frame (video_copy.h).
  static const std::vector<VideoEncoder> kMpeg{{"libx264", {"-preset", "veryfast", "-crf", "18", "-bf", "0"}},
                                               {"mpeg4", {"-q:v", "2"}}};
  static const std::vector<VideoEncoder> kVp9{
      {"libvpx-vp9", {"-crf", "24", "-b:v", "0", "-deadline", "good", "-cpu-used", "5", "-row-mt", "1"}}};
  static const std::vector<VideoEncoder> kProRes{{"prores_ks", {"-profile:v", "hq"}, "yuv422p10le"}};
  static const std::vector<VideoEncoder> kGif{{"gif", {}, ""}};
  static const std::vector<Container> kAll{
      // The index at the front, so that browsers play the file while they load it.
      {".mp4", {"-f", "mp4", "-movflags", "+faststart"}, kMpeg},
      {".mkv", {"-f", "matroska"}, kMpeg},
      {".webm", {"-f", "webm"}, kVp9},
      {".mov", {"-f", "mov"}, kProRes},
      {".gif", {"-f", "gif"}, kGif}};
  return kAll;
}

const Container& containerOf(const fs::path& file) {
  for (const Container& container : containers())
    if (file.extension() == container.extension) return container;
  throw ioError("a video cannot be written to a file of this name",
                fmt::format("names that end in {}", fmt::join(VideoWriter::extensions(), ", ")))
      .at({.file = file.string()});
}

int roundedToEven(int size) {
  return size + size % 2;
}

/// The picture's bytes with the last column and row repeated where the size is odd.
std::vector<std::uint8_t> evenSized(const Picture& picture) {
  constexpr std::size_t kPixel = 3;
  const std::size_t row = kPixel * static_cast<std::size_t>(picture.width);
  std::vector<std::uint8_t> bytes;
  bytes.reserve(kPixel * static_cast<std::size_t>(roundedToEven(picture.width)) *
                static_cast<std::size_t>(roundedToEven(picture.height)));
  for (int y = 0; y < roundedToEven(picture.height); ++y) {
    const auto begin =
        picture.rgb.begin() + static_cast<std::ptrdiff_t>(row) * std::min(y, picture.height - 1);
    const auto end = begin + static_cast<std::ptrdiff_t>(row);
    bytes.insert(bytes.end(), begin, end);
    if (picture.width % 2 != 0) bytes.insert(bytes.end(), end - kPixel, end);
  }
  return bytes;
}

std::vector<std::string> colorOptions(const VideoEncoder& encoder) {
  // A palette of its own for each frame: one for all would need all frames at once.
  if (encoder.pixels.empty())
    return {
        "-vf",
        "split[a][b];[a]palettegen=stats_mode=single[p];[b][p]paletteuse=new=1:dither=bayer:bayer_scale=4"};
  // The colours of HD video, and the file says so: players guess otherwise, some by the size of the picture.
  // Some encoders take that from the options, others from the frames.
  const std::string filter =
      "scale=out_color_matrix=bt709:out_range=tv:flags=accurate_rnd+full_chroma_int,format=" +
      encoder.pixels + ",setparams=range=tv:color_primaries=bt709:color_trc=bt709:colorspace=bt709";
  return {"-vf",   filter,       "-colorspace", "bt709",        "-color_primaries",
          "bt709", "-color_trc", "bt709",       "-color_range", "tv"};
}

std::vector<std::string> argumentsFor(const fs::path& file, const Container& container,
                                      const VideoEncoder& encoder, int width, int height, double frameRate) {
  // -xerror: without it ffmpeg ends with exit code 0 when the disk is full as it completes the file.
  std::vector<std::string> arguments{"-hide_banner", "-loglevel", "error", "-nostdin", "-y", "-xerror"};
  const auto add = [&](const std::vector<std::string>& more) {
    arguments.insert(arguments.end(), more.begin(), more.end());
  };
  // +discardcorrupt: where this program is killed within a frame, that frame is no reason to give up the
  // others.
  add({"-fflags", "+discardcorrupt", "-f", "rawvideo", "-pixel_format", "rgb24"});
  add({"-video_size", fmt::format("{}x{}", roundedToEven(width), roundedToEven(height))});
  add({"-framerate", fmt::format("{}", frameRate), "-i", "pipe:0"});
  add(colorOptions(encoder));
  add({"-c:v", encoder.name});
  add(encoder.options);
  add(container.options);
  add({"file:" + file.string()});  // without file:, a colon in the name would mean a protocol
  return arguments;
}

/// The one of this name; without options if it is none of ours, which ffmpeg may know still.
VideoEncoder encoderNamed(const Container& container, const std::string& name) {
  for (const VideoEncoder& encoder : container.encoders)
    if (encoder.name == name) return encoder;
  return {name, {}};
}

/// The first encoder that gets one black frame into the file. Throws why the best one does not.
VideoEncoder workingEncoder(const PartFile& part, const Container& container, int width, int height,
                            double frameRate) {
  const std::vector<std::uint8_t> black(std::size_t{3} * static_cast<std::size_t>(roundedToEven(width)) *
                                        static_cast<std::size_t>(roundedToEven(height)));
  std::optional<Error> first;
  for (const VideoEncoder& encoder : container.encoders) {
    const auto ffmpeg =
        startFfmpeg(part.target(), argumentsFor(part.path(), container, encoder, width, height, frameRate));
    const bool taken = ffmpeg->write(black);
    if (ffmpeg->finish() && taken) return encoder;
    if (!first) first = failureOf(*ffmpeg, part.target());
  }
  throw *first;
}

}  // namespace

std::vector<std::string> VideoWriter::extensions() {
  std::vector<std::string> all;
  for (const Container& container : containers()) all.push_back(container.extension);
  return all;
}

std::vector<std::string> VideoWriter::containerOptions(const fs::path& file) {
  return containerOf(file).options;
}

VideoWriter::VideoWriter(fs::path file, int width, int height, double frameRate, const std::string& encoder)
    : file_(std::move(file)),
      width_(width),
      height_(height),
      queue_(1, kLongestQueue, [this](std::int64_t, const Picture& picture) { feed(picture); }) {
  WEIR_CHECK(width > 0);
  WEIR_CHECK(height > 0);
  WEIR_CHECK(frameRate > 0);
  WEIR_CHECK(std::isfinite(frameRate));
  const Container& container = containerOf(file_);
  part_.emplace(file_);
  encoder_ = encoder.empty() ? workingEncoder(*part_, container, width, height, frameRate)
                             : encoderNamed(container, encoder);
  ffmpeg_ = startFfmpeg(file_, argumentsFor(part_->path(), container, encoder_, width, height, frameRate));
}

VideoWriter::~VideoWriter() {
  queue_.drop();
  if (ffmpeg_) ffmpeg_->cancel();
}

void VideoWriter::write(Picture picture) {
  WEIR_CHECK(!finished_);
  WEIR_CHECK(picture.isWhole());
  WEIR_CHECK(picture.width == width_);
  WEIR_CHECK(picture.height == height_);
  queue_.push(std::move(picture));
  ++frameCount_;
}

void VideoWriter::feed(const Picture& picture) {
  // A file that was removed can be written to, but nobody will ever see it.
  std::error_code error;
  if (!fs::exists(part_->path(), error))
    throw cannotWrite(file_, part_->path().string() + " was removed while it was being written");
  const bool even = picture.width % 2 == 0 && picture.height % 2 == 0;
  if (even ? ffmpeg_->write(picture.rgb) : ffmpeg_->write(evenSized(picture))) return;
  // It has ended, or is about to: time to say why, but not forever.
  ffmpeg_->finish(std::chrono::seconds(10));
  throw failureOf(*ffmpeg_, file_);
}

void VideoWriter::finish() {
  finished_ = true;
  queue_.finish();
  if (failure_) throw *failure_;
  if (!part_) return;
  try {
    complete();
  } catch (const Error& error) {
    failure_ = error;
    throw;
  }
}

void VideoWriter::complete() {
  if (frameCount_ == 0) ffmpeg_->cancel();
  const bool done = ffmpeg_->finish();
  if (frameCount_ > 0) {
    if (!done) throw failureOf(*ffmpeg_, file_);
    part_->keep();
  }
  part_.reset();
}

}  // namespace weir::rendering
