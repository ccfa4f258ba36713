// Gives the node ParticleFile the particles of VTKHDF files.
#pragma once

#include "nodes/particle_file/particle_reader.h"

namespace weir {

/// Reads the last step, or that of a time, so that a run can go on where an export ended. Does it in a
/// process of its own, as files come from anywhere; see isolated.h.
class VtkHdfParticleReader final : public ParticleReader {
 public:
  std::vector<std::string> extensions() const override { return {".vtkhdf"}; }
  ParticleData read(const std::filesystem::path& file) const override;
  ParticleData readAt(const std::filesystem::path& file, double time) const override;
};

}  // namespace weir
