#include "plugins/vtkhdf/particle_export.h"

#include <algorithm>
#include <utility>

#include "framework/base/build_info.h"
#include "framework/base/file_output.h"
#include "framework/base/text.h"
#include "framework/run/statistics.h"
#include "framework/scene/scene_file.h"

namespace weir {

namespace {

constexpr const char* kOptionName = "export";
/// The attribute that becomes the file's Points.
constexpr std::string_view kPositionName = "position";

Error noFluid(const std::filesystem::path& file) {
  return ioError("there is nothing to export: the scene has no fluid",
                 "a scene with a ParticleFluid, or another node that puts out a Fluid")
      .at({.file = file.string()});
}

bool has(const ParticleSet& particles, const AttributeInfo& wanted) {
  const AttributeInfo* found = particles.find(wanted.name);
  return found != nullptr && found->type == wanted.type;
}

VtkHdfAttribute attributeOf(const AttributeInfo& info) {
  return {.name = info.name,
          .components = info.type == AttributeType::kVec3 ? 3 : 1,
          .type = info.type == AttributeType::kInt ? VtkHdfType::kInt32 : VtkHdfType::kFloat32,
          .unit = info.unit};
}

/// Copies the first `count` elements to host memory that has room for them.
template <class T>
void download(const Array<T>& from, std::size_t count, void* to) {
  if (count > 0) from.device().download(to, from.data(), count * sizeof(T));
}

}  // namespace

ParticleExport::ParticleExport(std::filesystem::path file) : file_(std::move(file)) {}

ParticleExport::~ParticleExport() = default;

void ParticleExport::begin(Simulation& simulation) {
  findFluids(simulation);
  checkWritable(file_);
}

void ParticleExport::save(const StateWriter& to) {
  writer_->sync();
  std::string names;
  for (const Column& column : columns_) names += column.info.name + "\n";
  to.put("frames", writer_->framesWritten());
  to.put("attributes", std::span<const char>(names));
}

void ParticleExport::resume(Simulation& simulation, const StateReader& from) {
  begin(simulation);
  Earlier& earlier = earlier_.emplace();
  from.get("frames", earlier.frames);
  const std::vector<char> names = from.getAll<char>("attributes");
  for (auto begin = names.begin(); begin != names.end();) {
    const auto end = std::find(begin, names.end(), '\n');
    earlier.attributes.emplace_back(begin, end);
    begin = end + 1;
  }
}

void ParticleExport::findFluids(Simulation& simulation) {
  sources_.clear();
  for (const auto& node : simulation.scene().graph.nodes())
    for (const OutputPort* port : node->outputs())
      if (port->typeName() == Fluid::kPortType)
        sources_.push_back({node->name(), static_cast<const Output<Fluid>*>(port)});
  if (sources_.empty()) throw noFluid(file_);
}

void ParticleExport::frame(Simulation& simulation) {
  if (!writer_) {
    chooseSources();
    chooseColumns(simulation);
    makeFile(simulation);
  }
  warnOfNewAttributes(simulation);

  std::vector<std::size_t> counts;
  std::size_t total = 0;
  for (const Source& source : sources_) {
    counts.push_back(static_cast<std::size_t>(source.particles().refreshCount()));
    total += counts.back();
  }
  resize(total);
  for (std::size_t i = 0, first = 0; i < sources_.size(); first += counts[i++]) {
    fetch(sources_[i].particles(), first, counts[i]);
    if (several()) std::fill_n(fluidIndices_.begin() + std::ptrdiff_t(first), counts[i], int(i));
  }
  write(simulation.time());
}

void ParticleExport::chooseSources() {
  // A coupling may hand on a fluid that it got; its particles must be there once only.
  std::vector<const ParticleSet*> seen;
  std::erase_if(sources_, [&](const Source& source) {
    const ParticleSet* particles = (*source.fluid)->particles;
    if (particles == nullptr || std::count(seen.begin(), seen.end(), particles) > 0) return true;
    seen.push_back(particles);
    return false;
  });
  if (sources_.empty()) throw noFluid(file_);
}

void ParticleExport::chooseColumns(const Simulation& simulation) {
  columns_.clear();
  for (const Source& source : sources_)
    for (const AttributeInfo& info : source.particles().attributes()) {
      const bool shared = std::all_of(sources_.begin(), sources_.end(),
                                      [&](const Source& other) { return has(other.particles(), info); });
      if (!shared)
        warnOfMissing(simulation, info.name, source.name);
      else if (info.name != kPositionName && findColumn(info.name) == nullptr && isWanted(info.name))
        columns_.push_back({info, {}, {}});
    }
  if (several() && findColumn(kFluidIndexName) != nullptr)
    throw ioError(
        "the particles have an attribute 'fluid_index', which is what the export calls the number "
        "that tells several fluids apart",
        "another name for the attribute")
        .at({.file = file_.string()});
}

bool ParticleExport::isWanted(const std::string& attribute) const {
  return !earlier_ || std::count(earlier_->attributes.begin(), earlier_->attributes.end(), attribute) > 0;
}

void ParticleExport::warnOfNewAttributes(const Simulation& simulation) const {
  for (const Source& source : sources_)
    for (const AttributeInfo& info : source.particles().attributes())
      if (info.name != kPositionName && findColumn(info.name) == nullptr)
        warnOfMissing(simulation, info.name, source.name);
}

void ParticleExport::warnOfMissing(const Simulation& simulation, const std::string& attribute,
                                   const std::string& fluid) const {
  simulation.log().warnOnce("the export leaves out the attribute " + inQuotes(attribute) + " of the fluid " +
                            inQuotes(fluid) + ", which not all fluids have from the first frame on");
}

const ParticleExport::Column* ParticleExport::findColumn(std::string_view name) const {
  const auto found = std::find_if(columns_.begin(), columns_.end(),
                                  [&](const Column& column) { return column.info.name == name; });
  return found != columns_.end() ? &*found : nullptr;
}

void ParticleExport::makeFile(const Simulation& simulation) {
  VtkHdfLayout layout{.attributes = {}, .fields = {"particles"}};
  for (const Column& column : columns_) layout.attributes.push_back(attributeOf(column.info));
  if (several())
    layout.attributes.push_back({.name = kFluidIndexName, .type = VtkHdfType::kInt32, .unit = {}});
  if (earlier_) {
    writer_ = std::make_unique<VtkHdfWriter>(file_, std::move(layout), earlier_->frames);
    return;
  }
  writer_ = std::make_unique<VtkHdfWriter>(file_, std::move(layout));

  std::string names;
  for (const Source& source : sources_) names += source.name + "\n";
  writer_->setText("version", version());
  writer_->setText("scene", simulation.scene().text);
  writer_->setText("fluids", names);
}

void ParticleExport::resize(std::size_t particles) {
  positions_.resize(particles);
  if (several()) fluidIndices_.resize(particles);
  for (Column& column : columns_) {
    if (column.info.type == AttributeType::kInt)
      column.ints.resize(particles);
    else
      column.floats.resize(particles * (column.info.type == AttributeType::kVec3 ? 3 : 1));
  }
}

void ParticleExport::fetch(const ParticleSet& particles, std::size_t first, std::size_t count) {
  download(particles.positions(), count, positions_.data() + first);
  for (Column& column : columns_) {
    const std::string& name = column.info.name;
    switch (column.info.type) {
      case AttributeType::kFloat:
        download(particles.get<float>(name), count, column.floats.data() + first);
        break;
      case AttributeType::kVec3:
        download(particles.get<Vec3f>(name), count, column.floats.data() + 3 * first);
        break;
      case AttributeType::kInt:
        download(particles.get<int>(name), count, column.ints.data() + first);
        break;
    }
  }
}

void ParticleExport::write(double time) {
  VtkHdfFrame frame{.time = time,
                    .positions = positions_,
                    .attributes = {},
                    .fields = {static_cast<double>(positions_.size())}};
  for (const Column& column : columns_) {
    if (column.info.type == AttributeType::kInt)
      frame.attributes.emplace_back(std::span<const std::int32_t>(column.ints));
    else
      frame.attributes.emplace_back(std::span<const float>(column.floats));
  }
  if (several()) frame.attributes.emplace_back(std::span<const std::int32_t>(fluidIndices_));
  writer_->append(frame);
}

void ParticleExport::end(Simulation& simulation, RunEnd how) {
  if (!writer_) return;
  // After a failure the writer may have given up, and the frames that are there matter more than a report.
  if (how != RunEnd::kFailed) writer_->setText("statistics", writeJson(runStatistics(simulation, how)));
  writer_->close();
}

std::vector<OutputOption> ParticleExportKind::options() const {
  return {{.name = kOptionName,
           .argument = "FILE.vtkhdf",
           .extensions = {".vtkhdf"},
           .doc = "Write the particles of every frame, for ParaView and VTK"}};
}

std::unique_ptr<Observer> ParticleExportKind::create(const OutputPaths& paths) const {
  return std::make_unique<ParticleExport>(paths.at(kOptionName));
}

}  // namespace weir
