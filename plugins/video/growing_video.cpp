#include "plugins/video/growing_video.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <system_error>
#include <utility>

#include "plugins/video/frame_ledger.h"
#include "plugins/video/part_file.h"
#include "plugins/video/video_copy.h"

namespace weir::rendering {

namespace fs = std::filesystem;

namespace {

/// A digest of the last of the file's first bytes; 0 if there are fewer.
std::uint64_t markOf(const fs::path& file, std::uint64_t bytes) {
  constexpr std::uint64_t kMax = 1 << 16;
  std::string last(std::min(bytes, kMax), '\0');
  std::ifstream stream(file, std::ios::binary);
  stream.seekg(static_cast<std::streamoff>(bytes - last.size()));
  if (!stream.read(last.data(), static_cast<std::streamsize>(last.size()))) return 0;
  Digest digest;
  digest.add(last);
  return digest.value();
}

}  // namespace

GrowingVideo::GrowingVideo(fs::path file, const VideoSize& size, const VideoFormat& format,
                           const std::optional<VideoState>& earlier)
    : file_(std::move(file)), format_(format), state_{.size = size} {
  if (earlier && earlier->frames > 0) takeUp(*earlier);
  startPart();
}

GrowingVideo::~GrowingVideo() = default;

void GrowingVideo::takeUp(const VideoState& earlier) {
  const VideoSize &old = earlier.size, &now = state_.size;
  if (old.width != now.width || old.height != now.height)
    throw ioError(fmt::format("a video of {} x {} cannot be gone on with in pictures of {} x {}", old.width,
                              old.height, now.width, now.height),
                  "the size that the checkpoint's run had, or a new video")
        .at({.file = file_.string()});
  if (old.frameRate != now.frameRate)
    throw ioError(fmt::format("a video of {} frames a second cannot be gone on with at {}", old.frameRate,
                              now.frameRate),
                  "the rate that the checkpoint's run had, or a new video")
        .at({.file = file_.string()});
  for (const fs::path& place : {growingPlace(file_), file_}) PartFile::removeLeft(place);
  const fs::path grown = growingPlace(file_);
  if (earlier.bytes > 0 && markOf(grown, earlier.bytes) == earlier.mark) {
    cutFile(grown, earlier.bytes);  // what is behind that may be damaged
  } else {                          // it was completed since, or is of an older version of this program
    const std::int64_t found = countFrames(file_, earlier.frames);
    if (found < earlier.frames)
      throw ioError(fmt::format("the video holds {} frames, but the checkpoint was made when it had {}",
                                found, earlier.frames),
                    "the video that the checkpoint's run wrote, or a new one")
          .at({.file = file_.string()});
    copyVideo(file_, earlier.frames, file_, VideoKind::kGrowing);
  }
  state_ = earlier;
  grows_ = true;
}

void GrowingVideo::startPart() {
  part_ = std::make_unique<VideoWriter>(file_, state_.size, format_, state_);
  state_.encoder = part_->encoder();
}

void GrowingVideo::write(Picture picture) {
  if (failure_) throw *failure_;
  if (!part_) startPart();
  part_->write(std::move(picture));
}

void GrowingVideo::endPart() {
  if (failure_) throw *failure_;
  if (!part_) return;
  const std::unique_ptr<VideoWriter> part = std::move(part_);
  try {
    part->finish();
  } catch (const Error& error) {
    failure_ = error;
    throw;
  }
  state_.frames += part->frameCount();
}

void GrowingVideo::save() {
  endPart();
  if (state_.frames == 0) return;
  if (!grows_) copyVideo(file_, state_.frames, file_, VideoKind::kGrowing);
  grows_ = true;
  const fs::path place = growingPlace(file_);
  syncFile(place);
  std::error_code error;
  state_.bytes = fs::file_size(place, error);
  if (error) throw cannotWrite(place, error.message());
  state_.mark = markOf(place, state_.bytes);
}

void GrowingVideo::complete() {
  if (!grows_) return;
  const fs::path place = growingPlace(file_);
  copyVideo(place, state_.frames, file_, VideoKind::kComplete);
  std::error_code ignored;
  if (place != file_) fs::remove(place, ignored);
  grows_ = false;
}

void GrowingVideo::finish() {
  // The frames up to the last save() are a video also where those behind it failed.
  for (const auto step : {&GrowingVideo::endPart, &GrowingVideo::complete}) {
    try {
      (this->*step)();
    } catch (const Error& error) {
      if (!failure_) failure_ = error;
    }
  }
  if (failure_) throw *failure_;
}

}  // namespace weir::rendering
