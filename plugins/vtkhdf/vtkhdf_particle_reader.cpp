#include "plugins/vtkhdf/vtkhdf_particle_reader.h"

#include <algorithm>
#include <system_error>
#include <utility>

#include "framework/base/error.h"
#include "plugins/vtkhdf/isolated.h"
#include "plugins/vtkhdf/packed.h"
#include "plugins/vtkhdf/vtkhdf_reader.h"

namespace weir {

namespace {

ParticleData readLastStep(const std::filesystem::path& file) {
  VtkHdfStep step = VtkHdfReader(file).readLast();
  if (step.positions.empty()) throw ioError("the last step holds no particles", "one particle or more");
  ParticleData data{.positions = {}, .velocities = step.velocities(), .unused = {}};
  const VtkHdfArray* velocity = step.find("velocity");
  for (const VtkHdfArray& array : step.arrays)
    if (&array != velocity) data.unused.push_back(array.name);
  data.positions = std::move(step.positions);
  data.velocities.resize(data.positions.size());
  return data;
}

std::string packed(const ParticleData& data) {
  hdf5::Packer packer;
  packer.addAll(data.positions);
  packer.addAll(data.velocities);
  for (const std::string& name : data.unused) packer.addText(name);
  return packer.take();
}

/// Believes nothing, as a damaged file may have upset the process that packed it.
ParticleData unpacked(std::string_view bytes) {
  hdf5::Unpacker unpacker(bytes);
  ParticleData data;
  data.positions = unpacker.all<Vec3f>();
  data.velocities = unpacker.all<Vec3f>();
  while (!unpacker.atEnd()) data.unused.emplace_back(unpacker.text());
  const auto finite = [](const std::vector<Vec3f>& vectors) {
    return std::all_of(vectors.begin(), vectors.end(), [](const Vec3f& v) { return isFinite(v); });
  };
  if (data.positions.empty() || data.positions.size() != data.velocities.size() || !finite(data.positions) ||
      !finite(data.velocities))
    throw ioError("the file is damaged: what was read from it makes no sense");
  return data;
}

/// Far more than the slowest machine needs for a file of this size.
int cpuSecondsFor(const std::filesystem::path& file) {
  constexpr double kLeast = 20, kMost = 1e6, kBytesPerSecond = 1e6;
  std::error_code error;
  const auto size = std::filesystem::file_size(file, error);
  return static_cast<int>(error ? kLeast : std::min(kLeast + double(size) / kBytesPerSecond, kMost));
}

}  // namespace

ParticleData VtkHdfParticleReader::read(const std::filesystem::path& file) const {
  try {
    return unpacked(hdf5::runIsolated([&] { return packed(readLastStep(file)); }, cpuSecondsFor(file)));
  } catch (Error& error) {
    throw error.at({.file = file.string()});
  }
}

}  // namespace weir
