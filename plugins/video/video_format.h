// What a video file is made with: which encoders of ffmpeg, with which options, and which files hold what.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace weir::rendering {

/// kAuto is what the file's name stands for: H.264 (or else MPEG-4) in .mp4 and .mkv, VP9 in .webm, ProRes in
/// .mov, a palette in .gif.
enum class VideoCodec { kAuto, kH264, kVp9, kAv1, kProRes, kFfv1 };

struct VideoFormat {
  static constexpr int kUsualQuality = 80;

  VideoCodec codec = VideoCodec::kAuto;
  /// From 0 to 100, the same for all codecs: at equal numbers, videos are equally like the pictures. FFV1
  /// loses nothing whatever it is, and palettes know no quality.
  int quality = kUsualQuality;
  bool alpha = false;  ///< the pictures are transparent, and the video shall be
};

/// How a kind of video file is made: ffmpeg's name of the encoder, and its options.
struct VideoEncoder {
  std::string name;
  std::vector<std::string> options;
  std::string pixels = "yuv420p";  ///< the format of its pixels; "" if it takes its colours from a palette
  bool rgb = false;                ///< its pixels are red, green and blue
};

/// "AV1"
std::string_view codecName(VideoCodec codec);

/// What a video's name may end in, the usual one first: ".mp4", ".mkv", ".webm", ".mov", ".gif".
std::vector<std::string> videoExtensions();

/// Throws an io Error if the file's extension is none of videoExtensions(), and a scene Error if such a file
/// cannot hold that codec, or with it no transparency; both say what could.
void checkFormat(const std::filesystem::path& file, const VideoFormat& format);

/// ffmpeg's options for a file of this name. Throws an io Error if its extension is none of
/// videoExtensions().
std::vector<std::string> containerOptions(const std::filesystem::path& file);

/// A video that grows is a file that plays at any time and can be appended to: what ffmpeg makes with
/// growingOptions() is, behind what it made before.
///
/// Where it grows: in its place, or beside it if such a file cannot ("run.part.mov" for "run.gif").
std::filesystem::path growingPlace(const std::filesystem::path& file);
std::vector<std::string> growingOptions(const std::filesystem::path& file);

/// The encoders that can make the file, the best one first. Throws as checkFormat().
std::vector<VideoEncoder> encodersFor(const std::filesystem::path& file, const VideoFormat& format);

/// ffmpeg's options for it, and for the colours that it takes.
std::vector<std::string> encodingOptions(const VideoEncoder& encoder);

/// The names of those codecs, other than kAuto, that one of these encoders makes: "H.264, VP9".
std::string codecsOf(std::span<const std::string> encoders);

}  // namespace weir::rendering
