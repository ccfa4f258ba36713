// Reads particles from PLY files, in all three encodings: x, y, z and perhaps vx, vy, vz of the element
// "vertex", as float or double. Its other numbers are columns for attributes; lists, numbers of the type uint
// and all other elements are passed over.
#pragma once

#include "nodes/particle_file/particle_reader.h"

namespace weir {

class PlyReader final : public ParticleReader {
 public:
  std::vector<std::string> extensions() const override { return {".ply"}; }
  /// Errors name the line of the header or of ASCII data, or the row of binary data. A file that ends before
  /// or goes on behind what its header announces is an error, too.
  ParticleData read(const std::filesystem::path& file) const override;
};

}  // namespace weir
