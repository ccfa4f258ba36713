#include "plugins/video/saved_video.h"

#include <span>
#include <vector>

namespace weir::rendering {

void saveVideo(const VideoState& video, const StateWriter& to) {
  to.put("frames", video.frames);
  to.put("width", video.size.width);
  to.put("height", video.size.height);
  to.put("rate", video.size.frameRate);
  to.put("bytes", video.bytes);
  to.put("mark", video.mark);
  to.put("encoder", std::span<const char>(video.encoder));
}

std::optional<VideoState> savedVideo(const StateReader& from) {
  if (!from.has("frames")) return std::nullopt;
  VideoState video;
  from.get("frames", video.frames);
  from.get("width", video.size.width);
  from.get("height", video.size.height);
  from.get("rate", video.size.frameRate);
  if (from.has("bytes")) {
    from.get("bytes", video.bytes);
    from.get("mark", video.mark);
  }
  const std::vector<char> encoder = from.getAll<char>("encoder");
  video.encoder.assign(encoder.begin(), encoder.end());
  return video;
}

}  // namespace weir::rendering
