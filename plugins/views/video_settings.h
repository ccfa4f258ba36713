// The group "video" in the "render" section of a scene file: how --video encodes.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "framework/graph/configurable.h"
#include "plugins/video/video_format.h"

namespace weir {

template <>
struct EnumNames<rendering::VideoCodec> {
  static constexpr std::array<EnumName, 6> kNames{
      EnumName{"auto", "What suits the file: H.264 in .mp4 and .mkv, VP9 in .webm, ProRes in .mov."},
      EnumName{"h264", "H.264, which every player knows."},
      EnumName{"vp9", "VP9: smaller files, slower; transparent if the pictures are."},
      EnumName{"av1", "AV1: the smallest files."},
      EnumName{"prores", "ProRes, to be edited; transparent if the pictures are."},
      EnumName{"ffv1", "FFV1: large files without any loss, in .mkv; transparent if the pictures are."}};
};

namespace rendering {

class VideoSettings final : public Configurable {
 public:
  Param<VideoCodec> codec{
      *this, "codec", VideoCodec::kAuto, {.doc = "How frames are encoded, where ffmpeg has it."}};
  Param<int> quality{
      *this,
      "quality",
      VideoFormat::kUsualQuality,
      {.min = 0,
       .max = 100,
       .doc = "How much alike video and pictures are, the same for all codecs: 80 is hard to tell from the "
              "pictures, 60 is good, 40 is for small files. FFV1 and GIF do without."}};
  Param<std::optional<double>> rate{
      *this,
      "rate",
      std::nullopt,
      {.unit = "1/s",
       .min = 0.1,
       .max = 1000,
       .doc = "Frames that the video shows in a second; frames of the run are repeated or left out for that. "
              "Without it each frame of the run is shown once."}};
  Param<double> speed{
      *this,
      "speed",
      1,
      {.min = 1e-4,
       .max = 1e4,
       .doc = "Simulated seconds that the video shows in a second: 0.25 is slow motion (world.frame_rate "
              "should be higher then), 10 is time-lapse."}};

  VideoFormat format(bool alpha) const { return {codec, quality, alpha}; }
  /// Frames a second of the video of a run with this frame rate.
  double videoRate(double frameRate) const { return rate->value_or(frameRate * speed); }
  /// How often the video shows a frame of the run: frame k is shown from k / (frameRate speed) s on.
  std::int64_t timesShown(std::int64_t frame, double frameRate) const;
};

}  // namespace rendering
}  // namespace weir
