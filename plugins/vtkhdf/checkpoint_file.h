// Checkpoints as HDF5 files, for --checkpoint and --resume.
//
//   /checkpoint            attribute "format"; texts "program", "scene", "device"
//   /checkpoint/state/…    a data set for each array, in groups by its path, with its kind as an attribute
#pragma once

#include "framework/run/checkpoint.h"

namespace weir {

class Hdf5CheckpointStore final : public CheckpointStore {
 public:
  std::string_view extension() const override { return ".h5"; }
  void write(const std::filesystem::path& file, const Checkpoint& checkpoint) const override;
  Checkpoint read(const std::filesystem::path& file) const override;
};

}  // namespace weir
