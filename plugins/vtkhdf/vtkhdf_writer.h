// Exports particles to one file that ParaView and VTK read as an animation (VTKHDF, temporal PolyData).
//
// Frames are written by a thread of the writer's own while the simulation goes on. The file stands at its
// place from the first moment, and each frame is complete in it before the next one is begun: a program that
// is killed, or a disk that fills up, costs the frames after that one only.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "plugins/vtkhdf/vtkhdf_layout.h"

namespace weir {

class VtkHdfWriter {
 public:
  /// Makes the file with no frames. An existing file is replaced only after the new one could be made. Throws
  /// an io Error if the name does not end in .vtkhdf, if it is a folder, or if the file cannot be made.
  VtkHdfWriter(const std::filesystem::path& file, VtkHdfLayout layout);
  /// Goes on with a file of the same layout behind its first frames, see PolyDataFile.
  VtkHdfWriter(const std::filesystem::path& file, VtkHdfLayout layout, std::int64_t frames);
  /// Closes; an error that close() would have thrown is lost.
  ~VtkHdfWriter();

  /// Copies the frame and returns; waits while the frame before the last one is still being written, so that
  /// no more than two frames are held. Sizes and types must be those of the layout and times must rise
  /// (WEIR_CHECK). Throws the io Error of an earlier frame that could not be written; no frame is written
  /// from then on.
  void append(const VtkHdfFrame& frame);
  /// Keeps a text, such as the scene, in the file's group /simulation. Waits for frames that are being
  /// written.
  void setText(const std::string& name, std::string_view text);
  /// Waits until all frames are on the disk. Throws as append() does.
  void sync();
  /// Frames that are complete in the file.
  std::int64_t framesWritten() const;
  /// Writes what is left and completes the file. Throws the io Error of a frame that could not be written
  /// unless append() or setText() has thrown it. May be called again.
  void close();

 private:
  class Worker;
  std::unique_ptr<Worker> worker_;
};

}  // namespace weir
