// The option --blender of `weir run` and `weir render`: a folder that Blender opens, with the add-on that
// comes with Weir, and a .blend file of its last frame where there is a Blender.
#pragma once

#include <memory>

#include "framework/run/output_kind.h"

namespace weir::rendering {

class BlenderOutput final : public OutputKind {
 public:
  std::vector<OutputOption> options() const override;
  bool showsReplays() const override { return true; }
  std::unique_ptr<Observer> create(const OutputPaths& paths) const override;
};

}  // namespace weir::rendering
