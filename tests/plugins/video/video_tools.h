// Looking into videos with ffmpeg's own tools, and putting another program in ffmpeg's place.
#pragma once

#include <string>
#include <vector>

#include "plugins/video/picture.h"
#include "tests/support/child_process.h"
#include "tests/support/find_program.h"

namespace weir::test {

struct VideoInfo {
  int width = 0, height = 0;
  int frames = 0;         ///< counted by decoding
  std::string frameRate;  ///< as ffprobe writes it: "30/1"
  std::string codec;
  std::string pixelFormat;
  std::string colorSpace;
};

/// Fails the test and gives back what it can if ffprobe finds a fault in the file.
VideoInfo probeVideo(const std::string& file);

/// All frames, decoded.
std::vector<rendering::Picture> readVideo(const std::string& file);

/// Sets PATH and sets it back at the end.
class PathVariable {
 public:
  explicit PathVariable(const std::string& value);
  ~PathVariable();
  PathVariable(const PathVariable&) = delete;
  PathVariable& operator=(const PathVariable&) = delete;

 private:
  std::string before_;
};

/// A shell command that tells, as ffmpeg does, that this many frames are in the video, and leaves something
/// there.
std::string writesFrames(int frames);

/// A program "ffmpeg" that is found instead of the real one. It runs `trial` the first time it is called,
/// which takes all that it is given, and the shell commands `script` from then on.
class FakeFfmpeg {
 public:
  explicit FakeFfmpeg(const std::string& script, const std::string& trial = "cat > /dev/null");
  /// A file that the script can reach as $FOLDER/name.
  std::string operator/(const std::string& name) const { return folder_ / name; }

 private:
  TemporaryFolder folder_;
  PathVariable path_;
};

/// A program "ffmpeg" that fails where its arguments contain `word`, and is the real one otherwise.
class FfmpegWithout {
 public:
  explicit FfmpegWithout(const std::string& word);

 private:
  TemporaryFolder folder_;
  PathVariable path_;
};

}  // namespace weir::test
