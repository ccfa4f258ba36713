// --vdb DIR: the volume of all fluids at each frame, as OpenVDB files frame_00000.vdb, frame_00001.vdb, …
#pragma once

#include <memory>
#include <vector>

#include "framework/graph/configurable.h"
#include "framework/run/output_kind.h"

namespace weir {

/// The section "vdb" of a scene.
class VolumeSettings final : public Configurable {
 public:
  Param<float> voxel{
      *this,
      "voxel",
      2.0f,
      {.min = 0.1,
       .max = 100,
       .doc = "Side of a voxel, in spacings of the particles, of the finest fluid; smaller ones "
              "show the single particles."}};
};

class VolumeExportKind final : public OutputKind {
 public:
  std::vector<OutputOption> options() const override;
  bool showsReplays() const override { return true; }
  std::unique_ptr<Observer> create(const OutputPaths& paths) const override;
};

}  // namespace weir
