// Which columns of a table are the positions and velocities of particles: x, y, z and perhaps vx, vy, vz.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "nodes/particle_file/particle_reader.h"

namespace weir {

/// One particle: x, y, z [m], vx, vy, vz [m/s]; the velocity stays 0 if the table has none.
using ParticleRow = std::array<float, 6>;

class ParticleColumns {
 public:
  /// Takes the names of a table's columns, in any mix of cases. Throws an io Error without a place if x, y or
  /// z is missing, some but not all of vx, vy and vz are there, or one of the six is there twice.
  explicit ParticleColumns(const std::vector<std::string>& names);

  std::size_t size() const { return slots_.size(); }
  /// Where a column's numbers belong in a ParticleRow; nothing if they belong nowhere.
  std::optional<std::size_t> slot(std::size_t column) const { return slots_[column]; }
  /// The names of the columns without a slot.
  const std::vector<std::string>& unused() const { return unused_; }

  static std::string_view nameOfSlot(std::size_t slot);

 private:
  std::vector<std::optional<std::size_t>> slots_;
  std::vector<std::string> unused_;
};

/// The whole content of a regular file. Throws an io Error that names the file and says why it cannot be
/// read.
std::string readParticleFile(const std::filesystem::path& file);

inline void addParticle(const ParticleRow& row, ParticleData& data) {
  data.positions.push_back({row[0], row[1], row[2]});
  data.velocities.push_back({row[3], row[4], row[5]});
}

}  // namespace weir
