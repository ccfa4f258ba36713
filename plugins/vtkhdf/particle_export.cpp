#include "plugins/vtkhdf/particle_export.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <tuple>
#include <type_traits>
#include <utility>
#include <variant>

#include "framework/base/build_info.h"
#include "framework/base/digest.h"
#include "framework/base/text.h"
#include "framework/compute/host_copy.h"
#include "framework/graph/outputs_of.h"
#include "framework/run/checkpoint.h"
#include "framework/run/statistics.h"
#include "framework/scene/scene_file.h"
#include "plugins/vtkhdf/rank_files.h"

namespace weir {

namespace {

constexpr const char* kOptionName = "export";
/// The attribute that becomes the file's Points.
constexpr std::string_view kPositionName = "position";

Error noParticles(const std::filesystem::path& file) {
  return ioError("there is nothing to export: the scene has no particles",
                 "a scene with a ParticleFluid, or another node that puts out Particles")
      .at({.file = file.string()});
}

bool has(const ParticleSet& particles, const AttributeInfo& wanted) {
  const AttributeInfo* found = particles.find(wanted.name);
  return found != nullptr && found->type == wanted.type;
}

VtkHdfType typeOf(AttributeType type) {
  return withAttributeType(type, []<class T>(std::type_identity<T>) {
    using Number = typename AttributeTraits<T>::Number;
    if constexpr (std::is_same_v<Number, std::int64_t>) return VtkHdfType::kInt64;
    return std::is_same_v<Number, int> ? VtkHdfType::kInt32 : VtkHdfType::kFloat32;
  });
}

VtkHdfAttribute attributeOf(const AttributeInfo& info) {
  return {
      .name = info.name, .components = numbersIn(info.type), .type = typeOf(info.type), .unit = info.unit};
}

/// The numbers of an attribute on their way to the host, that many of each particle.
using ColumnCopy = std::variant<HostCopy<float>, HostCopy<int>, HostCopy<std::int64_t>>;

ColumnCopy columnOf(const AttributeInfo& info, Device& device) {
  return withAttributeType(info.type, [&]<class T>(std::type_identity<T>) -> ColumnCopy {
    return HostCopy<typename AttributeTraits<T>::Number>(device);
  });
}

/// What particles of a fluid have in place of an attribute that only others have.
template <class Number>
constexpr Number kMissing = std::is_floating_point_v<Number> ? std::numeric_limits<Number>::quiet_NaN()
                                                             : Number(-1);
/// At least as many of these on the device as were ever asked for.
class MissingNumbers {
 public:
  explicit MissingNumbers(Device& device)
      : numbers_(Array<float>(device), Array<int>(device), Array<std::int64_t>(device)) {}

  template <class Number>
  const Number* get(std::int64_t count) {
    auto& array = std::get<Array<Number>>(numbers_);
    if (array.size() < count)
      array.assign(std::vector<Number>(static_cast<std::size_t>(count), kMissing<Number>));
    return array.data();
  }

 private:
  std::tuple<Array<float>, Array<int>, Array<std::int64_t>> numbers_;
};

/// Asks for one attribute of the first `count` particles.
void startColumn(const ParticleSet& particles, const AttributeInfo& info, std::int64_t first,
                 std::int64_t count, MissingNumbers& missing, ColumnCopy& to) {
  withAttributeType(info.type, [&]<class T>(std::type_identity<T>) {
    using Number = typename AttributeTraits<T>::Number;
    const std::int64_t numbers = kNumbersIn<T> * count;
    const Number* from = has(particles, info)
                             ? reinterpret_cast<const Number*>(particles.get<T>(info.name).read().data())
                             : missing.get<Number>(numbers);
    std::get<HostCopy<Number>>(to).start(kNumbersIn<T> * first, from, numbers);
  });
}

std::string textOfRun(const Scene& scene, int ranks) {
  return fmt::format("{:08x}",
                     Digest().addText(version()).addText(checkpointScene(scene)).addNumber(ranks).value());
}

/// What some ranks have written cannot be gone on with by others.
void checkRanks(const StateReader& saved, int present, const std::filesystem::path& file) {
  const int before = ExportOfRanks::savedRanks(saved);
  if (before == present) return;
  const auto what = [](int files) {
    return files == 1 ? std::string("one file") : fmt::format("a file of each of {} ranks", files);
  };
  throw ioError(
      fmt::format("the export was written as {}, and would go on as {}", what(before), what(present)),
      before == 1 ? std::string("export.by_rank=false") : fmt::format("{} ranks", before),
      "or go on without --export")
      .at({.file = file.string()});
}

}  // namespace

/// The particles of all fluids, one fluid behind the other.
class ParticleExport::Frame final : public Snapshot {
 public:
  Frame(const std::vector<AttributeInfo>& columns, Device& device) : positions_(device), missing_(device) {
    for (const AttributeInfo& info : columns) columns_.push_back(columnOf(info, device));
  }

  /// Takes so many of each source.
  void start(const std::vector<Source>& sources, std::vector<std::int64_t> counts,
             const std::vector<AttributeInfo>& columns, double time) {
    time_ = time;
    counts_ = std::move(counts);
    spacing_ = std::numeric_limits<double>::infinity();
    for (const Source& source : sources)
      spacing_ = std::min<double>(spacing_, (*source.output)->material.spacing);
    const std::int64_t total = std::accumulate(counts_.begin(), counts_.end(), std::int64_t{0});
    positions_.resize(total);
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const std::int64_t numbers = numbersIn(columns[c].type) * total;
      std::visit([&](auto& copy) { copy.resize(numbers); }, columns_[c]);
    }
    std::int64_t first = 0;
    for (std::size_t i = 0; i < sources.size(); first += counts_[i++]) {
      const ParticleSet& particles = sources[i].particles();
      positions_.start(first, particles.positions().read().data(), counts_[i]);
      for (std::size_t c = 0; c < columns.size(); ++c)
        startColumn(particles, columns[c], first, counts_[i], missing_, columns_[c]);
    }
  }

  /// Waits until all has arrived. Rounds positions to multiples of `grid`, if it is not 0.
  VtkHdfFrame finish(float grid) {
    VtkHdfFrame frame{.time = time_, .positions = positions_.wait(), .attributes = {}, .fields = {}};
    if (grid > 0) frame.positions = rounded(frame.positions, grid);
    frame.fields = {static_cast<double>(frame.positions.size()), spacing_};
    for (ColumnCopy& column : columns_)
      std::visit([&](auto& copy) { frame.attributes.emplace_back(copy.wait()); }, column);
    if (counts_.size() > 1) frame.attributes.emplace_back(fluidIndices());
    return frame;
  }

  FrameOfRanks ofRanks;  ///< where there are some

 private:
  std::span<const Vec3f> rounded(std::span<const Vec3f> positions, float grid) {
    rounded_.clear();
    for (const Vec3f& p : positions)
      rounded_.push_back({roundedTo(grid, p.x), roundedTo(grid, p.y), roundedTo(grid, p.z)});
    return rounded_;
  }

  std::span<const std::int32_t> fluidIndices() {
    fluidIndices_.clear();
    for (std::size_t i = 0; i < counts_.size(); ++i)
      fluidIndices_.insert(fluidIndices_.end(), static_cast<std::size_t>(counts_[i]), static_cast<int>(i));
    return fluidIndices_;
  }

  double time_ = 0, spacing_ = 0;
  std::vector<Vec3f> rounded_;        // only if positions are rounded
  std::vector<std::int64_t> counts_;  // of each fluid
  HostCopy<Vec3f> positions_;
  std::vector<ColumnCopy> columns_;
  MissingNumbers missing_;
  std::vector<std::int32_t> fluidIndices_;  // only if there are several fluids
};

ParticleExport::ParticleExport(std::filesystem::path file) : file_(std::move(file)) {}

ParticleExport::ParticleExport(std::filesystem::path file, Communicator& ranks)
    : ranks_(std::in_place, std::move(file), ranks), file_(ranks_->ownFile()) {}

ParticleExport::~ParticleExport() = default;

void ParticleExport::begin(Simulation& simulation) {
  findSources(simulation);
  if (ranks_) ranks_->begin();
  if (ranks_) runText_ = textOfRun(simulation.scene(), ranks_->ranks());
  file_.begin(simulation);
  const auto section = simulation.scene().sections.find("export");
  if (section != simulation.scene().sections.end())
    settings_ = dynamic_cast<const ExportSettings*>(section->second.get());
  if (const float grid = settings().grid(); grid > 0)
    simulation.log().info(fmt::format(
        "export: coordinates are rounded to multiples of {:.3g} m and are off by {:.3g} m at most", grid,
        0.5f * grid));
}

void ParticleExport::save(const StateWriter& to) {
  // After a resume there may have been no frame yet that is written.
  if (ranks_) prepareRanks();
  if (!file_.isOpen()) openFile();
  file_.save(to);
  if (ranks_) ranks_->save(to);
  std::string names;
  for (const AttributeInfo& column : columns_) names += column.name + "\n";
  to.put("attributes", std::span<const char>(names));
}

void ParticleExport::resume(Simulation& simulation, const StateReader& from) {
  // All would say the same.
  if (!ranks_) checkRanks(from, 1, file_.path());
  if (ranks_ && ranks_->rank() == 0) checkRanks(from, ranks_->ranks(), ranks_->file());
  begin(simulation);
  file_.resume(from);
  if (ranks_) ranks_->resume(from);
  std::vector<std::string>& attributes = earlierAttributes_.emplace();
  const std::vector<char> names = from.getAll<char>("attributes");
  for (auto begin = names.begin(); begin != names.end();) {
    const auto end = std::find(begin, names.end(), '\n');
    attributes.emplace_back(begin, end);
    begin = end + 1;
  }
}

void ParticleExport::findSources(Simulation& simulation) {
  sources_.clear();
  for (const auto& [node, output] : outputsOf<Particles>(simulation.scene().graph))
    sources_.push_back({node, output, ranks_ ? dynamic_cast<OwnedParticles*>(&output->node()) : nullptr});
  if (sources_.empty()) throw noParticles(file_.path());
}

std::unique_ptr<Snapshot> ParticleExport::capture(Simulation& simulation, std::unique_ptr<Snapshot> used) {
  if (!chosen_) {
    chooseSources();
    chooseColumns(simulation);
    chosen_ = true;
  }
  warnOfNewAttributes(simulation);
  if (!settings().wants(simulation.frame(), simulation.scene().world.frameRate)) return nullptr;
  if (!used) used = std::make_unique<Frame>(columns_, simulation.device());
  Frame& frame = static_cast<Frame&>(*used);
  std::vector<std::int64_t> counts;
  for (const Source& source : sources_) counts.push_back(countOf(source));
  if (ranks_) {
    prepareRanks();
    frame.ofRanks = ranks_->share(counts, written_);
  }
  frame.start(sources_, std::move(counts), columns_, simulation.time());
  return used;
}

void ParticleExport::write(Snapshot& snapshot) {
  if (!file_.isOpen()) openFile();
  Frame& captured = static_cast<Frame&>(snapshot);
  const VtkHdfFrame frame = captured.finish(settings().grid());
  file_.writer().append(frame);
  written_ = file_.writer().framesWritten();
  // A file that was removed can be written to, but nobody will ever read it.
  std::error_code error;
  if (!std::filesystem::exists(file_.path(), error))
    throw ioError("the file was removed while it was being written").at({.file = file_.path().string()});
  if (ranks_) ranks_->add(frame, captured.ofRanks);
}

std::int64_t ParticleExport::countOf(const Source& source) const {
  const bool isAnothers = ranks_ && source.owned == nullptr && ranks_->rank() > 0;
  return isAnothers ? 0 : source.particles().refreshCount();
}

void ParticleExport::prepareRanks() {
  if (!std::exchange(prepared_, true)) ranks_->prepare(layout(), texts());
}

void ParticleExport::chooseSources() {
  // A node may hand on particles that it got; they must be there once only.
  std::vector<const ParticleSet*> seen;
  std::erase_if(sources_, [&](const Source& source) {
    const Particles& particles = **source.output;
    if (!particles.exist() || std::count(seen.begin(), seen.end(), &particles.set()) > 0) return true;
    seen.push_back(&particles.set());
    return false;
  });
  if (sources_.empty()) throw noParticles(file_.path());
}

void ParticleExport::chooseColumns(const Simulation& simulation) {
  for (const Source& source : sources_)
    for (const AttributeInfo& info : source.particles().attributes()) {
      const bool alike = std::all_of(sources_.begin(), sources_.end(), [&](const Source& other) {
        return has(other.particles(), info) || other.particles().find(info.name) == nullptr;
      });
      if (info.name == kPositionName || isColumn(info.name) || !isWanted(info.name)) continue;
      if (alike)
        columns_.push_back(info);
      else
        warnOfMissing(simulation, info.name, source.name, "which is of another type in another fluid");
    }
  checkAttributes();
  if (several() && isColumn(kFluidIndexName))
    throw ioError(
        "the particles have an attribute 'fluid_index', which is what the export calls the number "
        "that tells several fluids apart",
        "another name for the attribute")
        .at({.file = file_.path().string()});
}

void ParticleExport::checkAttributes() const {
  if (!settings().attributes.get()) return;
  std::vector<std::string> names;
  for (const Source& source : sources_)
    for (const AttributeInfo& info : source.particles().attributes())
      if (info.name != kPositionName && std::count(names.begin(), names.end(), info.name) == 0)
        names.push_back(info.name);
  for (const std::string& name : *settings().attributes.get())
    if (!isColumn(name))
      throw sceneError("the particles have no attribute " + inQuotes(name) + " that could be exported",
                       joinNames(names), didYouMean(name, names))
          .at({.pointer = "/export/attributes"});
}

bool ParticleExport::isWanted(const std::string& attribute) const {
  const auto& chosen = settings().attributes.get();
  if (chosen && std::count(chosen->begin(), chosen->end(), attribute) == 0) return false;
  return !earlierAttributes_ ||
         std::count(earlierAttributes_->begin(), earlierAttributes_->end(), attribute) > 0;
}

void ParticleExport::warnOfNewAttributes(const Simulation& simulation) const {
  for (const Source& source : sources_)
    for (const AttributeInfo& info : source.particles().attributes())
      if (info.name != kPositionName && !isColumn(info.name) && isWanted(info.name))
        warnOfMissing(simulation, info.name, source.name, "which it did not have at the first frame");
}

void ParticleExport::warnOfMissing(const Simulation& simulation, const std::string& attribute,
                                   const std::string& fluid, const std::string& reason) const {
  simulation.log().warnOnce("the export leaves out the attribute " + inQuotes(attribute) + " of the fluid " +
                            inQuotes(fluid) + ", " + reason);
}

bool ParticleExport::isColumn(std::string_view name) const {
  return std::any_of(columns_.begin(), columns_.end(),
                     [&](const AttributeInfo& column) { return column.name == name; });
}

VtkHdfLayout ParticleExport::layout() const {
  VtkHdfLayout layout{
      .attributes = {}, .fields = {"particles", "spacing"}, .roundPositions = settings().grid() > 0};
  for (const AttributeInfo& column : columns_) layout.attributes.push_back(attributeOf(column));
  if (several())
    layout.attributes.push_back({.name = kFluidIndexName, .type = VtkHdfType::kInt32, .unit = {}});
  return layout;
}

ExportTexts ParticleExport::texts() const {
  std::vector<std::string> names;
  for (const Source& source : sources_) names.push_back(source.name);
  ExportTexts texts = file_.texts("fluids", names);
  if (const float grid = settings().grid(); grid > 0)
    texts.emplace_back("position_error", fmt::format("{:.9g}", 0.5f * grid));
  if (ranks_) texts.emplace_back(kRunText, runText_);
  return texts;
}

void ParticleExport::openFile() {
  ExportTexts own = texts();
  if (ranks_) own.emplace_back("rank", std::to_string(ranks_->rank()));
  file_.open(layout(), own);
}

void ParticleExport::end(Simulation& simulation, RunEnd how) {
  if (ranks_) return endOnRanks(simulation, how);
  // After a failure the writer may have given up, and the frames that are there matter more than a report.
  if (file_.isOpen() && how != RunEnd::kFailed)
    file_.writer().setText("statistics", writeJson(runStatistics(simulation, how)));
  file_.close();
}

void ParticleExport::endOnRanks(Simulation& simulation, RunEnd how) {
  file_.close();
  if (!file_.isOpen()) return ranks_->removeEmptyFolder();
  if (how == RunEnd::kFailed) return ranks_->keepComplete();
  ExportTexts ended;
  if (ranks_->rank() == 0) ended.emplace_back("statistics", writeJson(runStatistics(simulation, how)));
  try {
    ranks_->complete(ended);
  } catch (const RanksEnded&) {
    ranks_->keepComplete();
    throw;
  }
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

bool ParticleExportKind::isAsked(const Scene& scene) const {
  const auto section = scene.sections.find("export");
  if (section == scene.sections.end()) return false;
  const auto* const settings = dynamic_cast<const ExportSettings*>(section->second.get());
  return settings != nullptr && settings->byRank;
}

std::unique_ptr<Observer> ParticleExportKind::create(const OutputPaths& paths, Communicator& ranks) const {
  return std::make_unique<ParticleExport>(paths.at(kOptionName), ranks);
}

}  // namespace weir
