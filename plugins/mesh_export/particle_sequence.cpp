#include "plugins/mesh_export/particle_sequence.h"

#include <array>
#include <utility>
#include <variant>

#include "framework/base/error.h"
#include "framework/compute/host_copy.h"
#include "framework/graph/outputs_of.h"
#include "plugins/mesh_export/mesh_text.h"

namespace weir {

namespace {

constexpr const char* kOption = "ply-particles";

/// The names of the three numbers of a vector.
std::array<std::string, 3> componentNames(const std::string& attribute) {
  if (attribute == "position") return {"x", "y", "z"};
  if (attribute == "velocity") return {"vx", "vy", "vz"};
  return {attribute + "_x", attribute + "_y", attribute + "_z"};
}

/// One attribute on its way to the host.
class AttributeCopy {
 public:
  AttributeCopy(const ParticleSet& particles, const AttributeInfo& info, std::int64_t count)
      : info_(info), copy_(makeCopy(particles.device(), info)) {
    switch (info.type) {
      case AttributeType::kFloat:
        start<float>(particles, count);
        break;
      case AttributeType::kVec3:
        start<Vec3f>(particles, count);
        break;
      case AttributeType::kInt:
        start<int>(particles, count);
        break;
    }
  }

  void addTo(std::vector<PlyColumn>& columns) {
    if (info_.type == AttributeType::kFloat) columns.push_back({info_.name, numbers<float>()});
    if (info_.type == AttributeType::kInt) columns.push_back({info_.name, numbers<int>()});
    if (info_.type != AttributeType::kVec3) return;
    const std::span<const Vec3f> vectors = numbers<Vec3f>();
    const std::span<const float> flat(reinterpret_cast<const float*>(vectors.data()), 3 * vectors.size());
    const std::array<std::string, 3> names = componentNames(info_.name);
    for (int k = 0; k < 3; ++k) columns.push_back({names[k], flat, 3, k});
  }

 private:
  using Copy = std::variant<HostCopy<float>, HostCopy<Vec3f>, HostCopy<int>>;

  static Copy makeCopy(Device& device, const AttributeInfo& info) {
    if (info.type == AttributeType::kFloat) return HostCopy<float>(device);
    if (info.type == AttributeType::kInt) return HostCopy<int>(device);
    return HostCopy<Vec3f>(device);
  }
  template <class T>
  void start(const ParticleSet& particles, std::int64_t count) {
    auto& copy = std::get<HostCopy<T>>(copy_);
    copy.resize(count);
    copy.start(0, particles.get<T>(info_.name).data(), count);
  }
  template <class T>
  std::span<const T> numbers() {
    return std::get<HostCopy<T>>(copy_).wait();
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
  // Attributes may come and go, so a used snapshot is no help.
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
