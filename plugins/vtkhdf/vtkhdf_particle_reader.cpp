#include "plugins/vtkhdf/vtkhdf_particle_reader.h"

#include <utility>

#include "framework/base/error.h"
#include "plugins/vtkhdf/vtkhdf_reader.h"

namespace weir {

ParticleData VtkHdfParticleReader::read(const std::filesystem::path& file) const {
  VtkHdfStep step = VtkHdfReader(file).readLast();
  try {
    if (step.positions.empty()) throw ioError("the last step holds no particles", "one particle or more");
    ParticleData data{.positions = {}, .velocities = step.velocities(), .unused = {}};
    const VtkHdfArray* velocity = step.find("velocity");
    for (const VtkHdfArray& array : step.arrays)
      if (&array != velocity) data.unused.push_back(array.name);
    data.positions = std::move(step.positions);
    data.velocities.resize(data.positions.size());
    return data;
  } catch (Error& error) {
    throw error.at({.file = file.string()});
  }
}

}  // namespace weir
