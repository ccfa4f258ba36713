#include "nodes/particle_file/particle_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <ranges>
#include <span>
#include <utility>

#include "framework/base/digest.h"
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

/// Throws a scene Error for the first row whose numbers are NaN or infinite.
void checkFinite(const ParticleColumn& column) {
  const auto check = [&](const auto& values, const auto& finite) {
    const auto bad = std::ranges::find_if_not(values, finite);
    if (bad != values.end())
      throw sceneError(fmt::format("{} is not finite in row {} of the file", inQuotes(column.info.name),
                                   bad - values.begin()),
                       "finite single-precision numbers");
  };
  if (const auto* numbers = std::get_if<std::vector<float>>(&column.values))
    check(*numbers, [](float v) { return std::isfinite(v); });
  if (const auto* vectors = std::get_if<std::vector<Vec3f>>(&column.values))
    check(*vectors, [](const Vec3f& v) { return isFinite(v); });
}

}  // namespace

void ParticleFile::give(ParticleData data) {
  WEIR_CHECK(data.positions.size() == data.velocities.size());
  file.set({});
  attributes.set({});
  given_ = std::move(data);
  read_.reset();
}

std::optional<std::uint32_t> ParticleFile::givenDigest() const {
  if (given() == nullptr) return std::nullopt;
  Digest digest;
  digest.add(std::as_bytes(std::span(given_->positions))).add(std::as_bytes(std::span(given_->velocities)));
  for (const ParticleColumn& column : given_->columns) {
    digest.addText(column.info.name);
    std::visit([&](const auto& values) { digest.add(std::as_bytes(std::span(values))); }, column.values);
  }
  return digest.value();
}

void ParticleFile::validate() const {
  if (file->empty() && !given_)
    throw sceneError("no file is given", "the path of a file with particles").inParameter(file.name());
}

ParticleData ParticleFile::read(const Registry& registry) const {
  if (const ParticleData* data = given()) return *data;
  ParticleData data = readFile(registry);
  WEIR_CHECK(data.positions.size() == data.velocities.size());
  choose(data);
  return data;
}

void ParticleFile::choose(ParticleData& data) const {
  std::vector<ParticleColumn> chosen;
  for (const std::string& name : *attributes) {
    const auto named = [&](const ParticleColumn& column) { return column.info.name == name; };
    if (std::ranges::any_of(chosen, named)) continue;
    const auto found = std::ranges::find_if(data.columns, named);
    if (found == data.columns.end()) {
      std::vector<std::string> names;
      for (const ParticleColumn& column : data.columns) names.push_back(column.info.name);
      throw sceneError(
          "the file has no numbers " + inQuotes(name) + " that can be an attribute",
          names.empty() ? "none: no file of this kind has them, or this one has no others" : joinNames(names),
          didYouMean(name, names))
          .inParameter(attributes.name());
    }
    checkFinite(*found);
    chosen.push_back(std::move(*found));
    const auto isOf = [&](const std::string& column) {
      return column == name || column == name + "_x" || column == name + "_y" || column == name + "_z";
    };
    std::erase_if(data.unused, isOf);
  }
  data.columns = std::move(chosen);
}

ParticleData ParticleFile::readFile(const Registry& registry) const {
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
  particles->attributes.clear();
  for (const ParticleColumn& column : read_->columns) particles->attributes.push_back({column.info});
  needs.add(bytesOfArrays(particles->maxCount, particles->positions, particles->velocities));
  needs.host = 2 * sizeof(Vec3f) * particles->maxCount;
  for (const ParticleColumn& column : read_->columns) {
    const double bytes = sizeof(float) * numbersIn(column.info.type) * particles->maxCount;
    needs.add(bytes);
    needs.host += bytes;
  }
}

void ParticleFile::reset(const SetupContext& context) {
  ParticleData data = read_ ? *std::exchange(read_, std::nullopt) : read(context.registry);
  moveTo(position, rotation->toQuaternion(), scale, data);
  if (const auto row = firstNotFinite(data))
    throw sceneError(fmt::format("scaled and moved, row {} of the file is not finite", *row),
                     "numbers that fit into single precision");
  context.log.info(
      fmt::format("node '{}': {} particles from {}{}{}", name(), data.positions.size(),
                  given() != nullptr ? "arrays" : printable(file->text, 200),
                  data.unused.empty() ? "" : "; not used: ", printable(joinNames(data.unused, ", "), 200)));
  particles->assign(context.device, data.positions, data.velocities);
  particles->attributes.clear();
  for (const ParticleColumn& column : data.columns)
    std::visit(
        [&]<class T>(const std::vector<T>& values) {
          particles->attributes.push_back({column.info, Array<T>(context.device, values)});
        },
        column.values);
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
