// Exports particles to one file that ParaView and VTK read as an animation (VTKHDF, temporal PolyData).
//
// The file stands at its place from the first moment, and each frame is complete in it before the next one is
// begun: a program that is killed, or a disk that fills up, costs the frames after that one only.
#pragma once

#include <cstdint>
#include <exception>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <string_view>

#include "plugins/vtkhdf/vtkhdf_layout.h"

namespace weir {

class PolyDataFile;

class VtkHdfWriter {
 public:
  /// Makes the file with no frames. An existing file is replaced only after the new one could be made. Throws
  /// an io Error if the name does not end in .vtkhdf, if it is a folder, or if the file cannot be made.
  VtkHdfWriter(const std::filesystem::path& file, VtkHdfLayout layout);
  /// Goes on with a file of the same layout behind its first frames, see PolyDataFile.
  VtkHdfWriter(const std::filesystem::path& file, VtkHdfLayout layout, std::int64_t frames);
  /// Closes; an error that close() would have thrown is lost.
  ~VtkHdfWriter();
  VtkHdfWriter(const VtkHdfWriter&) = delete;
  VtkHdfWriter& operator=(const VtkHdfWriter&) = delete;

  /// Writes a frame and hands it to the operating system. Sizes and types must be those of the layout and
  /// times must rise (WEIR_CHECK). Throws an io Error if it cannot be written; no more can be written from
  /// then on.
  void append(const VtkHdfFrame& frame);
  /// Keeps a text, such as the scene, in the file's group /simulation. Throws as append() does.
  void setText(const std::string& name, std::string_view text);
  /// Waits until all frames are on the disk. Throws as append() does.
  void sync();
  /// Frames that are complete in the file.
  std::int64_t framesWritten() const { return framesWritten_; }
  /// Completes the file. Throws an io Error if that fails, but not again what has been thrown before. May be
  /// called again.
  void close();

 private:
  void check(const VtkHdfFrame& frame) const;
  /// Runs something that writes. If it fails, the file is given up as it is.
  void attempt(const std::function<void()>& write);

  const VtkHdfLayout layout_;
  std::unique_ptr<PolyDataFile> file_;  // gone when it is closed or given up
  std::exception_ptr error_;
  double lastTime_ = -std::numeric_limits<double>::infinity();
  std::int64_t framesWritten_ = 0;
};

}  // namespace weir
