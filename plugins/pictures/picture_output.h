// The options --video and --images of `weir run`: one observer draws each frame once for both.
#pragma once

#include <memory>

#include "framework/run/output_by_ranks.h"
#include "framework/run/output_kind.h"

namespace weir::rendering {

class PictureOutput final : public OutputKind, public OutputByRanks {
 public:
  std::vector<OutputOption> options() const override;
  bool showsReplays() const override { return true; }
  std::unique_ptr<Observer> create(const OutputPaths& paths) const override;
  /// Of pictures that need no gathered particles (composited_frames.h).
  bool isAsked(const Scene& scene) const override;
  std::unique_ptr<Observer> create(const OutputPaths& paths, Communicator& ranks) const override;
};

}  // namespace weir::rendering
