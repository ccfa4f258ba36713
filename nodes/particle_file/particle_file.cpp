#include "nodes/particle_file/particle_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

#include "framework/base/text.h"
#include "framework/graph/memory_estimate.h"
#include "framework/graph/registry.h"
#include "nodes/particle_file/csv_reader.h"
#include "nodes/particle_file/ply_reader.h"

namespace weir {

namespace {

/// The built-in readers, then those of plugins by name.
std::vector<Service<ParticleReader>> allReaders(const Registry& registry) {
  std::vector<Service<ParticleReader>> readers;
  readers.push_back({"csv", std::make_unique<CsvReader>(), std::string(kOwnSource)});
  readers.push_back({"ply", std::make_unique<PlyReader>(), std::string(kOwnSource)});
  for (auto& service : registry.createServices<ParticleReader>()) readers.push_back(std::move(service));
  return readers;
}

void moveTo(const Vec3f& position, const Quatf& rotation, float scale, ParticleData& data) {
  for (Vec3f& p : data.positions) p = position + rotate(rotation, scale * p);
  for (Vec3f& v : data.velocities) v = rotate(rotation, scale * v);
}

/// The first row that scaling and moving made too large for single precision.
std::optional<std::size_t> firstNotFinite(const ParticleData& data) {
  for (std::size_t i = 0; i < data.positions.size(); ++i)
    if (!isFinite(data.positions[i]) || !isFinite(data.velocities[i])) return i;
  return std::nullopt;
}

}  // namespace

void ParticleFile::validate() const {
  if (file->empty())
    throw sceneError("no file is given", "the path of a file with particles").inParameter(file.name());
}

ParticleData ParticleFile::read(const Registry& registry) const {
  const std::string ending = lowerCase(file->resolved.extension().string());
  std::vector<std::string> known;
  for (const auto& [name, reader, source] : allReaders(registry)) {
    std::optional<ParticleData> data;
    const auto where = [&] { return hookText("particle reader " + inQuotes(name), "", source); };
    const auto ask = [&] {
      for (const std::string& extension : reader->extensions()) {
        if (extension == ending && !data) data = readWith(*reader);
        known.push_back(extension);
      }
    };
    callGuarded(source, where, ask, /*filesSayEnough=*/true);
    if (data) return std::move(*data);
  }
  throw sceneError(inQuotes(file->text) + (ending.empty() ? " has no ending" : " is of no known kind"),
                   "a file that ends in " + joinNames(known), "plugins can bring more kinds of files")
      .inParameter(file.name());
}

ParticleData ParticleFile::readWith(const ParticleReader& reader) const {
  if (!time.get()) return reader.read(file->resolved);
  try {
    return reader.readAt(file->resolved, *time.get());
  } catch (Error& error) {
    if (error.kind() != ErrorKind::kScene) throw;
    throw error.inParameter(time.name());
  }
}

void ParticleFile::estimate(const SetupContext& context, MemoryNeeds& needs) {
  read_ = read(context.registry);
  particles->maxCount = static_cast<double>(read_->positions.size());
  needs.add(bytesOfArrays(particles->maxCount, particles->positions, particles->velocities));
  needs.host = 2 * sizeof(Vec3f) * particles->maxCount;
}

void ParticleFile::reset(const SetupContext& context) {
  ParticleData data = read_ ? *std::exchange(read_, std::nullopt) : read(context.registry);
  WEIR_CHECK(data.positions.size() == data.velocities.size());
  moveTo(position, rotation->toQuaternion(), scale, data);
  if (const auto row = firstNotFinite(data))
    throw sceneError(fmt::format("scaled and moved, row {} of the file is not finite", *row),
                     "numbers that fit into single precision");
  context.log.info(fmt::format(
      "node '{}': {} particles from {}{}{}", name(), data.positions.size(), printable(file->text, 200),
      data.unused.empty() ? "" : "; not used: ", printable(joinNames(data.unused, ", "), 200)));
  particles->assign(context.device, data.positions, data.velocities);
  count_ = particles->count;
}

void ParticleFile::step(const StepContext& context) {
  // Whoever takes particles in every step must get these once only.
  if (context.index > 0) *particles = {};
}

void ParticleFile::report(NodeReport& report) {
  report.statistics["particles_read"] = count_;
}

}  // namespace weir
