// Reads particles from tables of text:
//
//   # a comment
//   x, y, z, vx, vy, vz
//   0.1, 0.2, 0.3, 0, 0, -1
//
// The first line that is neither blank nor a comment names the columns, in any order; see ParticleColumns.
// Fields are separated by commas, may have blanks around them, and may stand in double quotes. Lines end in
// LF or CRLF. Numbers have a decimal point, whatever the locale.
#pragma once

#include "framework/base/api.h"
#include "nodes/particle_file/particle_reader.h"

namespace WEIR_API weir {

class CsvReader final : public ParticleReader {
 public:
  std::vector<std::string> extensions() const override { return {".csv"}; }
  /// Errors name line and column (in bytes) of the field.
  ParticleData read(const std::filesystem::path& file) const override;
};

}  // namespace weir
