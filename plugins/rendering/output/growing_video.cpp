#include "plugins/rendering/output/growing_video.h"

#include <fmt/format.h>

#include <utility>

#include "plugins/rendering/output/video_copy.h"

namespace weir::rendering {

namespace fs = std::filesystem;

namespace {

/// "run.from_8.mp4": a name that is the same whenever a run goes on at this frame.
fs::path pieceOf(const fs::path& file, std::int64_t first) {
  return fs::path(file).replace_filename(
      fmt::format("{}.from_{}{}", file.stem().string(), first, file.extension().string()));
}

/// What a killed run, and the ffmpeg that it left behind, made of frames that come again.
void removeLeftovers(const fs::path& piece) {
  std::error_code ignored;
  fs::remove(piece, ignored);
  fs::path part = piece;
  fs::remove(part.replace_extension(".part" + piece.extension().string()), ignored);
}

}  // namespace

GrowingVideo::GrowingVideo(fs::path file, const VideoSize& size, const VideoFormat& format,
                           const std::optional<VideoState>& earlier)
    : file_(std::move(file)), format_(format), state_{.size = size, .encoder = {}} {
  if (earlier && earlier->frames > 0) takeUp(*earlier);
  startPiece();
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
  const std::int64_t found = countFrames(file_);
  if (found < earlier.frames)
    throw ioError(fmt::format("the video holds {} frames, but the checkpoint was made when it had {}", found,
                              earlier.frames),
                  "the video that the checkpoint's run wrote, or a new one")
        .at({.file = file_.string()});
  if (found > earlier.frames) cutVideo(file_, earlier.frames);
  state_ = earlier;
}

void GrowingVideo::startPiece() {
  const fs::path target = state_.frames == 0 ? file_ : pieceOf(file_, state_.frames);
  if (state_.frames > 0) removeLeftovers(target);
  piece_ = std::make_unique<VideoWriter>(target, state_.size, format_, state_.encoder);
  state_.encoder = piece_->encoder();
}

void GrowingVideo::write(Picture picture) {
  if (failure_) throw *failure_;
  if (!piece_) startPiece();
  piece_->write(std::move(picture));
}

void GrowingVideo::endPiece() {
  if (failure_) throw *failure_;
  if (!piece_) return;
  try {
    piece_->finish();
    const std::int64_t frames = piece_->frameCount();
    piece_.reset();
    if (frames > 0 && state_.frames > 0) {
      const fs::path piece = pieceOf(file_, state_.frames);
      joinVideos({{file_, static_cast<double>(state_.frames) / state_.size.frameRate},
                  {piece, static_cast<double>(frames) / state_.size.frameRate}},
                 file_);
      removeLeftovers(piece);
    }
    state_.frames += frames;
  } catch (const Error& error) {
    failure_ = error;
    throw;
  }
}

void GrowingVideo::save() {
  endPiece();
  if (state_.frames > 0) syncFile(file_);
}

void GrowingVideo::finish() {
  endPiece();
}

}  // namespace weir::rendering
