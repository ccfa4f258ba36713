// Copying the frames of a video into another file, without encoding them again but for a .gif that has grown.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

namespace weir::rendering {

struct VideoSource {
  std::filesystem::path file;
  std::optional<std::uintmax_t> bytes;  ///< all that counts of it; none: all that is there
};

/// How many frames a video holds, or `most` if it holds more. Throws an io Error if there is no such file or
/// ffmpeg cannot read it.
std::int64_t countFrames(const VideoSource& video, std::int64_t most);

/// A video as others expect it, or one that grows (video_format.h).
enum class VideoKind { kComplete, kGrowing };

/// Makes a video of the first `frames` frames of another one, in the place of `video` or where that grows;
/// the file is on the disk when this returns, and replaces the one that is there (which may be the source) at
/// once. Throws an io Error; what is there is then as it was.
void copyVideo(const VideoSource& source, std::int64_t frames, const std::filesystem::path& video,
               VideoKind kind);

/// Waits until the file, and its name, are on the disk.
void syncFile(const std::filesystem::path& file);

}  // namespace weir::rendering
