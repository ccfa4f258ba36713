// The option --usd of `weir run` and `weir render`: particles with ids, velocities and widths, surfaces,
// solids, materials and the camera, for programs that read USD.
//
// FILE.usda is the root layer (usd_stage.h), FILE_frames beside it the folder with a layer for each frame
// (crate_file.h). The root layer is written anew now and then, so a run that is killed can be opened.
#pragma once

#include <memory>

#include "framework/run/output_kind.h"

namespace weir::rendering {

class UsdOutput final : public OutputKind {
 public:
  std::vector<OutputOption> options() const override;
  bool showsReplays() const override { return true; }
  std::unique_ptr<Observer> create(const OutputPaths& paths) const override;
};

}  // namespace weir::rendering
