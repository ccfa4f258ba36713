// Copying the frames of a video into another file, without encoding them again but for a .gif that has grown.
#pragma once

#include <cstdint>
#include <filesystem>

namespace weir::rendering {

/// How many frames a video holds, or `max` if it holds more. Throws an io Error if there is no such file or
/// ffmpeg cannot read it.
std::int64_t countFrames(const std::filesystem::path& video, std::int64_t max);

/// A video as others expect it, or one that grows (video_format.h).
enum class VideoKind { kComplete, kGrowing };

/// Makes a video of the first `frames` frames of another one, in the place of `video` or where that grows;
/// the file is on the disk when this returns, and replaces the one that is there (which may be the source) at
/// once. Throws an io Error; what is there is then as it was.
void copyVideo(const std::filesystem::path& source, std::int64_t frames, const std::filesystem::path& video,
               VideoKind kind);

/// Cuts a file off behind that many bytes: it is replaced by a new one, as the ffmpeg of a killed run may
/// still be appending to it. Throws an io Error; the file is then as it was.
void cutFile(const std::filesystem::path& file, std::uintmax_t bytes);

/// Waits until the file, and its name, are on the disk.
void syncFile(const std::filesystem::path& file);

}  // namespace weir::rendering
