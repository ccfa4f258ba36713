// Exports as recordings, for `weir render`.
#pragma once

#include "nodes/particle_file/recording.h"

namespace weir {

/// Opens and reads a file in a process of its own first, as a damaged one can crash the HDF5 library (see
/// isolated.h); frames are read in this one, when they are asked for.
class VtkHdfRecordingReader final : public RecordingReader {
 public:
  std::vector<std::string> extensions() const override { return {".vtkhdf"}; }
  std::unique_ptr<Recording> open(const std::filesystem::path& file) const override;
};

}  // namespace weir
