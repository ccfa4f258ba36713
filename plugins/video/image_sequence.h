// A folder of numbered pictures: frame_00000.png, frame_00001.png, …
//
// Frames of an earlier run are replaced one by one. Those with higher numbers than this run reaches stay
// where they are, since they may be all that is left of a longer run; leftovers() tells of them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "plugins/video/picture.h"
#include "plugins/video/picture_queue.h"

namespace weir::rendering {

class ImageSequence {
 public:
  /// "frame_00012.png"
  static std::string nameOf(std::int64_t frame);

  /// Makes the folder if it is missing; the folder above must be there. Throws an io Error if it cannot be
  /// made, is not a folder, or if no picture can be written in it.
  /// The first picture is that of the frame `first`.
  explicit ImageSequence(std::filesystem::path folder, std::int64_t first = 0);
  /// Pictures that are still waiting are lost unless finish() has been called. Whole files only are left
  /// behind.
  ~ImageSequence() = default;

  /// Hands the next frame to the threads that write the files; waits only while several frames are waiting
  /// already. The picture must be whole (WEIR_CHECK). Throws the io Error of an earlier frame that could not
  /// be written, which names its file; no frame is written from then on.
  void write(Picture picture);
  /// Waits until all files so far are written. Throws as write() does.
  void wait() { queue_.wait(); }
  /// Waits until all files are written. Throws as write() does. May be called again.
  void finish();

  /// Those before the first one count.
  std::int64_t frameCount() const { return frameCount_; }
  /// A warning that names the files in the folder that look like frames following this run's last one; "" if
  /// there are none.
  std::string leftovers() const;

 private:
  std::filesystem::path folder_;
  std::int64_t frameCount_;
  PictureQueue queue_;
};

}  // namespace weir::rendering
