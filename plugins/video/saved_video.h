// What a checkpoint knows of a video that is gone on with.
#pragma once

#include <optional>

#include "framework/graph/state.h"
#include "plugins/video/video_writer.h"

namespace weir::rendering {

void saveVideo(const VideoState& video, const StateWriter& to);
/// Nothing if there was none.
std::optional<VideoState> savedVideo(const StateReader& from);

}  // namespace weir::rendering
