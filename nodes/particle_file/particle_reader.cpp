#include "nodes/particle_file/particle_reader.h"

#include "framework/base/error.h"

namespace weir {

ParticleData ParticleReader::readAt(const std::filesystem::path&, double) const {
  throw sceneError("a time is given, but files of this kind hold one moment only", "no time");
}

}  // namespace weir
