#include "plugins/mesh_export/particle_sequence.h"

#include <utility>
#include <variant>

#include "framework/base/error.h"
#include "framework/compute/host_copy.h"
#include "framework/graph/outputs_of.h"
#include "plugins/mesh_export/mesh_text.h"

namespace weir {

namespace {

constexpr const char* kOption = "ply-particles";

/// What the numbers of an attribute are called.
std::vector<std::string> columnNames(const AttributeInfo& info) {
  if (info.name == "position") return {"x", "y", "z"};
  if (info.name == "velocity") return {"vx", "vy", "vz"};
  std::vector<std::string> names;
  for (const std::string_view component : componentsOf(info.type))
    names.push_back(component.empty() ? info.name : info.name + "_" + std::string(component));
  return names;
}

/// One attribute on its way to the host.
class AttributeCopy {
 public:
  AttributeCopy(const ParticleSet& particles, const AttributeInfo& info, std::int64_t count)
      : info_(info), copy_(makeCopy(particles, info, count)) {}

  void addTo(std::vector<PlyColumn>& columns) {
    std::visit([&]<class T>(HostCopy<T>& copy) { add(copy.wait(), columns); }, copy_);
  }

 private:
  using Copy = AttributeTypes::VariantOf<HostCopy>;

  static Copy makeCopy(const ParticleSet& particles, const AttributeInfo& info, std::int64_t count) {
    return withAttributeType(info.type, [&]<class T>(std::type_identity<T>) -> Copy {
      HostCopy<T> copy(particles.device());
      copy.resize(count);
      copy.start(0, particles.get<T>(info.name).read().data(), count);
      return copy;
    });
  }
  template <class T>
  void add(std::span<const T> elements, std::vector<PlyColumn>& columns) const {
    using Number = typename AttributeTraits<T>::Number;
    const std::span<const Number> numbers(reinterpret_cast<const Number*>(elements.data()),
                                          kNumbersIn<T> * elements.size());
    const std::vector<std::string> names = columnNames(info_);
    for (int k = 0; k < kNumbersIn<T>; ++k)
      columns.push_back({names[static_cast<std::size_t>(k)], numbers, kNumbersIn<T>, k});
  }

  AttributeInfo info_;
  Copy copy_;
};

}  // namespace

class ParticleSequence::Frame final : public Snapshot {
 public:
  struct Columns {
    std::int64_t count = 0;
    std::vector<AttributeCopy> attributes;
  };

  std::int64_t number = 0;
  std::vector<Columns> sources;  // in the order of sources_
};

void ParticleSequence::begin(Simulation& simulation) {
  sources_.clear();
  for (const auto& [node, output] : outputsOf<Particles>(simulation.scene().graph))
    sources_.push_back({node, output});
  if (sources_.empty())
    throw ioError("there is nothing to write: the scene has no particles",
                  "a scene with a ParticleFluid, or another node that puts out Particles")
        .at({.file = folder_.string()});
  files_.emplace(folder_, ".ply");
}

std::unique_ptr<Snapshot> ParticleSequence::capture(Simulation& simulation, std::unique_ptr<Snapshot>) {
  // Attributes may come and go, so a used snapshot does not help.
  auto frame = std::make_unique<Frame>();
  frame->number = simulation.frame();
  for (const Source& source : sources_) {
    Frame::Columns& to = frame->sources.emplace_back();
    if (!(*source.output)->exist()) continue;
    ParticleSet& particles = (*source.output)->set();
    to.count = particles.refreshCount();
    for (const AttributeInfo& info : particles.attributes())
      to.attributes.emplace_back(particles, info, to.count);
  }
  return frame;
}

void ParticleSequence::write(Snapshot& snapshot) {
  auto& frame = static_cast<Frame&>(snapshot);
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    if (frame.sources[i].attributes.empty()) continue;
    std::vector<PlyColumn> columns;
    for (AttributeCopy& attribute : frame.sources[i].attributes) attribute.addTo(columns);
    files_->write(sources_[i].node, frame.number, plyOf(frame.sources[i].count, columns));
  }
}

std::vector<OutputOption> ParticleSequenceKind::options() const {
  return {{kOption, "DIR", {}, "Write each frame's particles as PLY files into a folder"}};
}

std::unique_ptr<Observer> ParticleSequenceKind::create(const OutputPaths& paths) const {
  return std::make_unique<ParticleSequence>(paths.at(kOption));
}

}  // namespace weir
