// A video that can be gone on with: by the same run after a checkpoint, and by one that resumes.
//
// An encoder cannot be stopped within a video and gone on with, so each checkpoint ends one. Its frames are
// appended as they come to a file that plays at any time: from the first checkpoint on, the video is in its
// place (a .gif only as of then, see growingPlace()). At the end it is copied once into a file
// as others expect it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "framework/base/error.h"
#include "plugins/video/picture.h"
#include "plugins/video/video_writer.h"

namespace weir::rendering {

class GrowingVideo {
 public:
  /// A new video; see VideoWriter's constructor for all but `earlier`. With `earlier` the first frames of the
  /// video at `file` stay, and all behind them are cut off. Throws an io Error if they are not there, or were
  /// of another size, rate or codec.
  GrowingVideo(std::filesystem::path file, const VideoSize& size, const VideoFormat& format = {},
               const std::optional<VideoState>& earlier = std::nullopt);
  /// Frames since the last save() are lost without finish().
  ~GrowingVideo();

  /// As VideoWriter::write.
  void write(Picture picture);
  /// Brings all frames so far into the video, and the video to the disk. Throws an io Error; then the video
  /// is as the last save() left it, and nothing more can be written.
  void save();
  /// The same, for the last time. May be called again. Without a frame there is no video.
  void finish();

  /// As of the last save().
  const VideoState& state() const { return state_; }

 private:
  void takeUp(const VideoState& earlier);
  void startPart();
  void endPart();
  void complete();

  std::filesystem::path file_;
  VideoFormat format_;
  VideoState state_;
  bool grows_ = false;                 // since the first save(), at growingPlace()
  std::unique_ptr<VideoWriter> part_;  // null after a save() until the next frame
  std::optional<Error> failure_;
};

}  // namespace weir::rendering
