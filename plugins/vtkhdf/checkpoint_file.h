// Checkpoints as HDF5 files, for --checkpoint and --resume.
//
//   /checkpoint            attribute "format"; texts "program", "scene", "device", "inputs"; attribute
//   "digest", of
//                          the texts and of the digests of all arrays
//   /checkpoint/state/…    a data set for each array, in groups by its path, with its kind and its digest as
//                          attributes
//
// Digests (framework/base/digest.h) are of what is read and not of bytes of the file, so no damage that
// matters is missed, wherever it is.
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
