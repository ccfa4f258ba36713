// Cutting and joining videos without encoding their frames again.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace weir::rendering {

/// How many frames a video holds. Throws an io Error if there is no such file or ffmpeg cannot read it.
std::int64_t countFrames(const std::filesystem::path& video);

/// Leaves the first `frames` frames of the video, which must have been joined there or end there. The file is
/// replaced at once, when the new one is whole. Throws an io Error; the video is then as it was.
void cutVideo(const std::filesystem::path& video, std::int64_t frames);

struct VideoPiece {
  std::filesystem::path file;
  double seconds;  ///< frames / frame rate
};

/// Makes `video` of the pieces, one behind the other; it may be one of them. All must be of one encoder, size
/// and frame rate. The file is on the disk when this returns, and it is replaced at once. Throws an io Error;
/// the video is then as it was.
void joinVideos(const std::vector<VideoPiece>& pieces, const std::filesystem::path& video);

/// Waits until the file, and its name, are on the disk.
void syncFile(const std::filesystem::path& file);

}  // namespace weir::rendering
