#include "plugins/video/video_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <system_error>
#include <utility>

#include "framework/base/check.h"
#include "framework/base/text.h"
#include "plugins/video/ffmpeg.h"
#include "plugins/video/piped_program.h"

namespace weir::rendering {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kLongestQueue = 4;

int roundedToEven(int size) {
  return size + size % 2;
}

std::size_t channelsOf(const VideoFormat& format) {
  return format.alpha ? 4 : 3;
}

/// The bytes of a picture with the last column and row repeated where the size is odd.
std::vector<std::uint8_t> evenSized(std::span<const std::uint8_t> pixels, int width, int height) {
  const std::size_t row = pixels.size() / static_cast<std::size_t>(height);
  const std::size_t pixel = row / static_cast<std::size_t>(width);
  std::vector<std::uint8_t> bytes;
  bytes.reserve((row + pixel) * static_cast<std::size_t>(roundedToEven(height)));
  for (int y = 0; y < roundedToEven(height); ++y) {
    const auto begin = pixels.begin() + static_cast<std::ptrdiff_t>(row) * std::min(y, height - 1);
    const auto end = begin + static_cast<std::ptrdiff_t>(row);
    bytes.insert(bytes.end(), begin, end);
    if (width % 2 != 0) bytes.insert(bytes.end(), end - static_cast<std::ptrdiff_t>(pixel), end);
  }
  return bytes;
}

/// For a video in a file of its own, which will be the target.
std::vector<std::string> wholeVideo(const PartFile& part) {
  std::vector<std::string> output = containerOptions(part.target());
  output.push_back(urlOf(part.path()));
  return output;
}

/// For what is appended to a video.
std::vector<std::string> moreOfVideo(const fs::path& target, const VideoState& earlier) {
  std::vector<std::string> output = growingOptions(target);
  const double begin = static_cast<double>(earlier.frames) / earlier.size.frameRate;
  output.insert(output.end(), {"-output_ts_offset", fmt::format("{:.6f}", begin), "pipe:1"});
  return output;
}

std::vector<std::string> argumentsFor(const VideoFormat& format, const VideoEncoder& encoder,
                                      const VideoSize& size, const std::vector<std::string>& output) {
  std::vector<std::string> arguments;
  const auto add = [&](const std::vector<std::string>& more) {
    arguments.insert(arguments.end(), more.begin(), more.end());
  };
  // +discardcorrupt: where this program is killed within a frame, that frame is not a reason to give up the
  // others.
  add({"-fflags", "+discardcorrupt", "-f", "rawvideo", "-pixel_format", format.alpha ? "rgba" : "rgb24"});
  add({"-video_size", fmt::format("{}x{}", roundedToEven(size.width), roundedToEven(size.height))});
  add({"-framerate", fmt::format("{}", size.frameRate), "-i", "pipe:0"});
  add(encodingOptions(encoder));
  add(output);
  return arguments;
}

/// Why none of the encoders works, of which the best one failed for this reason.
Error noEncoder(const fs::path& file, const VideoFormat& format, const std::vector<VideoEncoder>& wanted,
                const Error& reason) {
  const std::vector<std::string> there = listEncoders(file);
  std::vector<std::string> missing;
  for (const VideoEncoder& encoder : wanted)
    if (std::find(there.begin(), there.end(), encoder.name) == there.end()) missing.push_back(encoder.name);
  if (there.empty() || missing.size() < wanted.size()) return reason;
  const std::string codec = format.codec == VideoCodec::kAuto ? file.extension().string() + " files"
                                                              : std::string(codecName(format.codec));
  return ioError(fmt::format("the program ffmpeg that was found has no encoder for {} ({})", codec,
                             fmt::join(missing, " or ")),
                 codecsOf(there) + ", for which it has encoders")
      .at({.file = file.string()});
}

/// The first encoder that gets one black frame into the file. Throws why there is none.
VideoEncoder workingEncoder(const PartFile& part, const VideoFormat& format, const VideoSize& size) {
  const std::vector<std::uint8_t> black(channelsOf(format) *
                                        static_cast<std::size_t>(roundedToEven(size.width)) *
                                        static_cast<std::size_t>(roundedToEven(size.height)));
  const std::vector<VideoEncoder> encoders = encodersFor(part.target(), format);
  std::optional<Error> first;
  for (const VideoEncoder& encoder : encoders) {
    const auto ffmpeg = startFfmpeg(part.target(), argumentsFor(format, encoder, size, wholeVideo(part)));
    const bool taken = ffmpeg->write(black);
    if (ffmpeg->finish() && taken) return encoder;
    if (!first) first = failureOf(*ffmpeg, part.target());
  }
  throw noEncoder(part.target(), format, encoders, *first);
}

/// The one of this name. Throws an io Error if the format has none.
VideoEncoder encoderNamed(const fs::path& file, const VideoFormat& format, const std::string& name) {
  for (const VideoEncoder& encoder : encodersFor(file, format))
    if (encoder.name == name) return encoder;
  throw ioError("the video was begun with the encoder " + inQuotes(name) + ", which does not make " +
                    std::string(codecName(format.codec)),
                "the codec that the video was begun with")
      .at({.file = file.string()});
}

}  // namespace

VideoWriter::VideoWriter(fs::path file, const VideoSize& size, const VideoFormat& format,
                         const VideoState& earlier)
    : file_(std::move(file)),
      size_(size),
      format_(format),
      queue_(1, kLongestQueue, [this](std::int64_t, const Picture& picture) { feed(picture); }) {
  WEIR_CHECK(size.width > 0);
  WEIR_CHECK(size.height > 0);
  WEIR_CHECK(size.frameRate > 0);
  WEIR_CHECK(std::isfinite(size.frameRate));
  checkFormat(file_, format);
  std::vector<std::string> output;
  if (earlier.frames == 0) {
    part_.emplace(file_);
    encoder_ = workingEncoder(*part_, format, size);
    output = wholeVideo(*part_);
  } else {
    part_.emplace(growingPlace(file_), PartPlace::kAppended);
    encoder_ = encoderNamed(file_, format, earlier.encoder);
    output = moreOfVideo(file_, earlier);
  }
  ffmpeg_ = startFfmpeg(file_, argumentsFor(format, encoder_, size, output), part_->path());
}

VideoWriter::~VideoWriter() {
  queue_.drop();
  if (ffmpeg_) ffmpeg_->cancel();
}

void VideoWriter::write(Picture picture) {
  WEIR_CHECK(!finished_);
  WEIR_CHECK(picture.isWhole());
  WEIR_CHECK(picture.width == size_.width);
  WEIR_CHECK(picture.height == size_.height);
  queue_.push(std::move(picture));
  ++frameCount_;
}

void VideoWriter::feed(const Picture& picture) {
  // A file that was removed can be written to, but nobody will ever see it.
  std::error_code error;
  if (!fs::exists(part_->path(), error))
    throw cannotWrite(file_, part_->path().string() + " was removed while it was being written");
  const std::vector<std::uint8_t> rgba = format_.alpha ? picture.rgba() : std::vector<std::uint8_t>();
  const std::vector<std::uint8_t>& pixels = format_.alpha ? rgba : picture.rgb;
  const bool even = picture.width % 2 == 0 && picture.height % 2 == 0;
  if (even ? ffmpeg_->write(pixels) : ffmpeg_->write(evenSized(pixels, picture.width, picture.height)))
    return;
  ffmpeg_->finish();  // it has ended, or is about to, or is beyond its limit
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

/// An ffmpeg that is content may have made less than it was given.
void VideoWriter::checkFrames() const {
  std::error_code error;
  if (fs::file_size(part_->path(), error) == part_->begin() || error)
    throw cannotWrite(file_, "ffmpeg ended without an error, but the video is empty");
  if (const std::int64_t frames = toldFrames(*ffmpeg_); frames < frameCount_)
    throw cannotWrite(file_, fmt::format("ffmpeg ended without an error, but has written {} of {} frames",
                                         frames, frameCount_));
}

void VideoWriter::complete() {
  if (frameCount_ == 0) ffmpeg_->cancel();
  const bool done = ffmpeg_->finish();
  if (frameCount_ > 0) {
    if (!done) throw failureOf(*ffmpeg_, file_);
    checkFrames();
    part_->keep();
  }
  part_.reset();
}

}  // namespace weir::rendering
