#include "plugins/vtkhdf/vtkhdf_particle_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "framework/base/error.h"
#include "framework/base/packed.h"
#include "plugins/vtkhdf/isolated.h"
#include "plugins/vtkhdf/vtkhdf_reader.h"

namespace weir {

namespace {

VtkHdfStep stepAt(const VtkHdfReader& reader, const std::optional<double>& time) {
  const std::vector<double>& times = reader.times();
  if (!time || times.empty()) return reader.readLast();
  // Times that were written as decimals need not be exact.
  constexpr double kTolerance = 1e-6;
  if (*time < times.front() - kTolerance || *time > times.back() + kTolerance)
    throw ioError(fmt::format("the file has no moment at {:g} s", *time),
                  fmt::format("from {:g} to {:g} s", times.front(), times.back()));
  return reader.read(reader.nearestStep(*time));
}

ParticleData readStep(const std::filesystem::path& file, const std::optional<double>& time) {
  const VtkHdfReader reader(file);
  VtkHdfStep step = stepAt(reader, time);
  if (const std::int64_t polygons = reader.polygonCount(reader.nearestStep(step.time)); polygons > 0)
    throw ioError(fmt::format("the file holds a surface of {} polygons, no particles", polygons),
                  "what --export wrote", "MeshFile reads it, and MeshSampler fills it with particles");
  if (step.positions.empty())
    throw ioError(time ? fmt::format("the step at {:g} s holds no particles", step.time)
                       : std::string("the last step holds no particles"),
                  "one particle or more");
  ParticleData data{.positions = {}, .velocities = step.velocities(), .unused = {}};
  const VtkHdfArray* velocity = step.find("velocity");
  for (const VtkHdfArray& array : step.arrays)
    if (&array != velocity) data.unused.push_back(array.name);
  data.positions = std::move(step.positions);
  data.velocities.resize(data.positions.size());
  return data;
}

std::string packed(const ParticleData& data) {
  Packer packer;
  packer.addAll(data.positions);
  packer.addAll(data.velocities);
  for (const std::string& name : data.unused) packer.addText(name);
  return packer.take();
}

/// Believes nothing, as a damaged file may have upset the process that packed it.
ParticleData unpacked(std::string_view bytes) {
  Unpacker unpacker(bytes);
  ParticleData data;
  data.positions = unpacker.all<Vec3f>();
  data.velocities = unpacker.all<Vec3f>();
  while (!unpacker.atEnd()) data.unused.emplace_back(unpacker.text());
  const auto finite = [](const std::vector<Vec3f>& vectors) {
    return std::all_of(vectors.begin(), vectors.end(), [](const Vec3f& v) { return isFinite(v); });
  };
  if (data.positions.empty() || data.positions.size() != data.velocities.size() || !finite(data.positions) ||
      !finite(data.velocities))
    throw ioError("the file is damaged: its contents are inconsistent");
  return data;
}

ParticleData readIsolated(const std::filesystem::path& file, const std::optional<double>& time) {
  try {
    return unpacked(
        hdf5::runIsolated([&] { return packed(readStep(file, time)); }, hdf5::cpuSecondsFor(file)));
  } catch (Error& error) {
    throw error.at({.file = file.string()});
  }
}

}  // namespace

ParticleData VtkHdfParticleReader::read(const std::filesystem::path& file) const {
  return readIsolated(file, std::nullopt);
}

ParticleData VtkHdfParticleReader::readAt(const std::filesystem::path& file, double time) const {
  return readIsolated(file, time);
}

}  // namespace weir
