#include "plugins/video/video_format.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "framework/base/error.h"

namespace weir::rendering {

namespace fs = std::filesystem;

namespace {

/// An encoder's own number at the qualities 0, 20, 40, 60, 80 and 100. At each of them the structural
/// similarity (SSIM) of video and pictures was made the same: 12.5, 15, 18, 20.5, 23 and 26 dB, measured with
/// ffmpeg's filter ssim in a moving picture of water.
using Scale = std::array<double, 6>;

constexpr Scale kX264{41, 35, 30, 25, 18, 12};
constexpr Scale kMpeg4{31, 11, 6, 3, 2, 2};
constexpr Scale kVpx{63, 58, 47, 35, 20, 6};
constexpr Scale kSvt{63, 60, 55, 44, 26, 6};
constexpr Scale kAom{63, 58, 47, 35, 20, 6};
constexpr Scale kProRes{0, 0, 1, 2, 3, 3};  // the profiles proxy, LT, standard and HQ

std::string numberAt(const Scale& scale, int quality) {
  const double place = std::clamp(quality, 0, 100) / 20.0;
  const std::size_t left = std::min(static_cast<std::size_t>(place), scale.size() - 2);
  const double part = place - static_cast<double>(left);
  return fmt::format("{}", std::lround(scale[left] + part * (scale[left + 1] - scale[left])));
}

/// What the file's extension stands for.
struct Container {
  std::string extension;
  std::vector<std::string> options, growing;
  std::vector<VideoCodec> codecs;  ///< the usual one first; none if it has one of its own
};

/// Fragments that each say at what time they begin. ffmpeg passes over the headers of those that were
/// appended.
constexpr const char* kFragments = "+frag_keyframe+empty_moov+default_base_moof+frag_discont+skip_trailer";

const std::vector<Container>& containers() {
  using enum VideoCodec;
  static const std::vector<Container> kAll{
      // The index at the front, so that browsers play the file while they load it.
      {".mp4",
       {"-f", "mp4", "-movflags", "+faststart"},
       {"-f", "mp4", "-movflags", kFragments},
       {kH264, kVp9, kAv1}},
      {".mkv", {"-f", "matroska"}, {"-f", "matroska"}, {kH264, kVp9, kAv1, kProRes, kFfv1}},
      {".webm", {"-f", "webm"}, {"-f", "webm"}, {kVp9, kAv1}},
      {".mov", {"-f", "mov"}, {"-f", "mov", "-movflags", kFragments}, {kProRes, kH264}},
      // A .gif ends where it says so, but its frames can be kept elsewhere. Some come with times in frames,
      // others in hundredths of a second.
      {".gif", {"-f", "gif"}, {"-f", "mov", "-movflags", kFragments, "-video_track_timescale", "10000"}, {}}};
  return kAll;
}

const Container& containerOf(const fs::path& file) {
  for (const Container& container : containers())
    if (file.extension() == container.extension) return container;
  throw ioError("a video cannot be written to a file of this name",
                fmt::format("names that end in {}", fmt::join(videoExtensions(), ", ")))
      .at({.file = file.string()});
}

bool holds(const Container& container, VideoCodec codec) {
  return codec == VideoCodec::kAuto ||
         std::find(container.codecs.begin(), container.codecs.end(), codec) != container.codecs.end();
}

/// kAuto if the file has a palette.
VideoCodec codecIn(const Container& container, VideoCodec wanted) {
  if (wanted != VideoCodec::kAuto || container.codecs.empty()) return wanted;
  return container.codecs.front();
}

bool canBeTransparent(VideoCodec codec, const Container& container) {
  // What reads .mp4 does not expect VP9's second picture, that of the opacity.
  return codec == VideoCodec::kProRes || codec == VideoCodec::kFfv1 ||
         (codec == VideoCodec::kVp9 && container.extension != ".mp4");
}

std::vector<VideoEncoder> av1Encoders(int quality) {
  return {{"libsvtav1", {"-preset", "8", "-crf", numberAt(kSvt, quality)}},
          {"libaom-av1", {"-crf", numberAt(kAom, quality), "-b:v", "0", "-cpu-used", "8", "-row-mt", "1"}}};
}

std::vector<VideoEncoder> vp9Encoders(const VideoFormat& format) {
  VideoEncoder vpx{"libvpx-vp9",
                   {"-crf", numberAt(kVpx, format.quality), "-b:v", "0", "-deadline", "good", "-cpu-used",
                    "5", "-row-mt", "1"}};
  if (format.alpha) {
    vpx.options.insert(vpx.options.end(), {"-auto-alt-ref", "0"});  // or the encoder refuses opacity
    vpx.pixels = "yuva420p";
  }
  return {vpx};
}

std::vector<VideoEncoder> proResEncoders(const VideoFormat& format) {
  if (format.alpha) return {{"prores_ks", {"-profile:v", "4444", "-alpha_bits", "16"}, "yuva444p10le"}};
  return {{"prores_ks", {"-profile:v", numberAt(kProRes, format.quality)}, "yuv422p10le"}};
}

/// `fallBack`: a codec that is always there may take its place.
std::vector<VideoEncoder> h264Encoders(int quality, bool fallBack) {
  // Fast enough not to slow the simulation down. No frames that depend on later ones (-bf 0): so videos can
  // be cut and gone on with at any frame.
  std::vector<VideoEncoder> all{
      {"libx264", {"-preset", "veryfast", "-crf", numberAt(kX264, quality), "-bf", "0"}}};
  // Some distributions build ffmpeg without x264; its own MPEG-4 encoder is always there.
  if (fallBack) all.push_back({"mpeg4", {"-q:v", numberAt(kMpeg4, quality)}});
  return all;
}

std::vector<std::string> colorOptions(const VideoEncoder& encoder) {
  // A palette of its own for each frame: one for all would need all frames at once.
  if (encoder.pixels.empty())
    return {
        "-vf",
        "split[a][b];[a]palettegen=stats_mode=single[p];[b][p]paletteuse=new=1:dither=bayer:bayer_scale=4"};
  if (encoder.rgb) return {"-vf", "format=" + encoder.pixels};
  // The colours of HD video, and the file says so: players guess otherwise, some by the size of the picture.
  // Some encoders take that from the options, others from the frames.
  const std::string filter =
      "scale=out_color_matrix=bt709:out_range=tv:flags=accurate_rnd+full_chroma_int,format=" +
      encoder.pixels + ",setparams=range=tv:color_primaries=bt709:color_trc=bt709:colorspace=bt709";
  return {"-vf",   filter,       "-colorspace", "bt709",        "-color_primaries",
          "bt709", "-color_trc", "bt709",       "-color_range", "tv"};
}

}  // namespace

std::string_view codecName(VideoCodec codec) {
  switch (codec) {
    case VideoCodec::kH264:
      return "H.264";
    case VideoCodec::kVp9:
      return "VP9";
    case VideoCodec::kAv1:
      return "AV1";
    case VideoCodec::kProRes:
      return "ProRes";
    case VideoCodec::kFfv1:
      return "FFV1";
    case VideoCodec::kAuto:
      break;
  }
  return "auto";
}

std::vector<std::string> videoExtensions() {
  std::vector<std::string> all;
  for (const Container& container : containers()) all.push_back(container.extension);
  return all;
}

void checkFormat(const fs::path& file, const VideoFormat& format) {
  const Container& container = containerOf(file);
  if (!holds(container, format.codec)) {
    std::vector<std::string> others;
    for (const Container& other : containers())
      if (holds(other, format.codec)) others.push_back(other.extension);
    std::string inside = "no codec but its own";
    if (!container.codecs.empty()) {
      std::vector<std::string_view> names;
      for (const VideoCodec codec : container.codecs) names.push_back(codecName(codec));
      inside = fmt::format("{}", fmt::join(names, ", "));
    }
    throw sceneError(fmt::format("a {} file cannot hold {}", container.extension, codecName(format.codec)),
                     fmt::format("{} in {}; or a file whose name ends in {}", inside, container.extension,
                                 fmt::join(others, ", ")));
  }
  const VideoCodec codec = codecIn(container, format.codec);
  if (format.alpha && !canBeTransparent(codec, container))
    throw sceneError(
        fmt::format("a {} file {}cannot be transparent", container.extension,
                    container.codecs.empty() ? std::string() : fmt::format("of {} ", codecName(codec))),
        "ProRes in .mov, VP9 in .webm, FFV1 in .mkv, or --images");
}

std::vector<std::string> containerOptions(const fs::path& file) {
  return containerOf(file).options;
}

fs::path growingPlace(const fs::path& file) {
  return file.extension() == ".gif" ? fs::path(file).replace_extension(".part.mov") : file;
}

std::vector<std::string> growingOptions(const fs::path& file) {
  std::vector<std::string> options = containerOf(file).growing;
  options.insert(options.end(), {"-avoid_negative_ts", "disabled"});  // times stay as they are
  return options;
}

std::vector<VideoEncoder> encodersFor(const fs::path& file, const VideoFormat& format) {
  checkFormat(file, format);
  switch (codecIn(containerOf(file), format.codec)) {
    case VideoCodec::kH264:
      return h264Encoders(format.quality, format.codec == VideoCodec::kAuto);
    case VideoCodec::kVp9:
      return vp9Encoders(format);
    case VideoCodec::kAv1:
      return av1Encoders(format.quality);
    case VideoCodec::kProRes:
      return proResEncoders(format);
    case VideoCodec::kFfv1:
      return {{"ffv1", {"-level", "3", "-g", "1"}, format.alpha ? "bgra" : "bgr0", true}};
    case VideoCodec::kAuto:
      break;
  }
  // Each frame with a palette of its own, without which it could not be copied; old ffmpegs know no others.
  return {{"gif", {"-global_palette", "0"}, ""}, {"gif", {}, ""}};
}

std::vector<std::string> encodingOptions(const VideoEncoder& encoder) {
  std::vector<std::string> options = colorOptions(encoder);
  options.insert(options.end(), {"-c:v", encoder.name});
  options.insert(options.end(), encoder.options.begin(), encoder.options.end());
  return options;
}

std::string codecsOf(std::span<const std::string> encoders) {
  using enum VideoCodec;
  std::vector<std::string_view> names;
  const auto isThere = [&](const VideoEncoder& encoder) {
    return std::find(encoders.begin(), encoders.end(), encoder.name) != encoders.end();
  };
  for (const VideoCodec codec : {kH264, kVp9, kAv1, kProRes, kFfv1}) {
    const std::vector<VideoEncoder> all = encodersFor("any.mkv", {.codec = codec});
    if (std::any_of(all.begin(), all.end(), isThere)) names.push_back(codecName(codec));
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace weir::rendering
