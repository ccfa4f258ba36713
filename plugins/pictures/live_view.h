// The pictures and videos of those who watch a run in the studio: drawn as for --video, with cameras of their
// own.
#pragma once

#include "framework/run/live_pictures.h"

namespace weir::rendering {

class LiveView final : public LivePictures {
 public:
  std::vector<std::string> videoExtensions() const override;
  std::unique_ptr<LiveRenderer> open(Simulation& simulation) const override;
};

}  // namespace weir::rendering
