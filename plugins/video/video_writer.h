// Makes a video of pictures. The program ffmpeg encodes them, so that Weir is bound to no version of its
// libraries.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "plugins/video/part_file.h"
#include "plugins/video/picture.h"
#include "plugins/video/picture_queue.h"
#include "plugins/video/video_format.h"

namespace weir::rendering {

class PipedProgram;

/// Of the frames: pixels, and frames a second.
struct VideoSize {
  int width = 0, height = 0;
  double frameRate = 0;
};

/// What all parts of a video must have in common, and how much there is of it.
struct VideoState {
  std::int64_t frames = 0;  ///< 0: it is new
  VideoSize size;
  std::string encoder;      ///< ffmpeg's name of it
  std::uint64_t bytes = 0;  ///< of the file, which frames may have been appended to since; 0: not known
  std::uint64_t mark = 0;   ///< a digest of the last of them, by which the file is known again
};

/// A new video has another name, "run.part.mp4" for "run.mp4", until finish(). One that is gone on with grows
/// at its growingPlace(). If the whole program is killed, ffmpeg completes that file with the frames it has
/// got.
class VideoWriter {
 public:
  /// All of `size` is positive (WEIR_CHECK). Of a size that is odd, the last column or row is shown twice, as
  /// the formats hold even sizes only. One black frame is encoded as a trial, so that what cannot work fails
  /// here. Throws what checkFormat() does, and an io Error if there is no ffmpeg on the PATH, if it cannot
  /// make such a video (with the reason that it gives, or with the codecs that it has), or if the file cannot
  /// be written. A video that is gone on with takes its encoder without a trial.
  VideoWriter(std::filesystem::path file, const VideoSize& size, const VideoFormat& format = {},
              const VideoState& earlier = {});
  /// Without finish(): stops ffmpeg and leaves nothing of this writer's frames behind.
  ~VideoWriter();

  /// Hands the next frame to the thread that feeds ffmpeg; waits only while several frames are waiting
  /// already. The picture must be whole and of the video's size (WEIR_CHECK). Its opacity is dropped unless
  /// the format has alpha. Throws the io Error of an earlier frame that could not be written, with ffmpeg's
  /// reason; no frame is written from then on.
  void write(Picture picture);
  /// Completes the video and puts it in its place; a file that is there is replaced. Without a frame there is
  /// no video, and what is in its place stays. Throws as write() does, and may be called again.
  void finish();

  /// That this writer has taken.
  std::int64_t frameCount() const { return frameCount_; }
  /// ffmpeg's name of the encoder that is used: the best one that works in the ffmpeg that was found.
  const std::string& encoder() const { return encoder_.name; }

 private:
  void feed(const Picture& picture);
  void checkFrames() const;
  void complete();

  std::filesystem::path file_;
  VideoSize size_;
  VideoFormat format_;
  std::int64_t frameCount_ = 0;
  bool finished_ = false;
  std::optional<Error> failure_;  // of complete()
  std::optional<PartFile> part_;  // until it is in its place
  VideoEncoder encoder_;
  std::unique_ptr<PipedProgram> ffmpeg_;  // the queue's thread has it until the queue is finished
  PictureQueue queue_;
};

}  // namespace weir::rendering
