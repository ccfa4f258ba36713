#include "plugins/openvdb/volume_export.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <system_error>
#include <utility>

#include "framework/compute/host_copy.h"
#include "framework/graph/outputs_of.h"
#include "framework/particles/particles.h"
#include "plugins/openvdb/density_grid.h"

namespace weir {

namespace {

namespace fs = std::filesystem;

constexpr const char* kOption = "vdb";

class VolumeSnapshot final : public Snapshot {
 public:
  struct Part {
    explicit Part(Device& device) : positions(device), volumes(device) {}
    HostCopy<Vec3f> positions;
    HostCopy<float> volumes;  ///< of each particle, m³; empty where all have the same
    float volume = 0;         ///< the one that all have
  };
  std::vector<Part> parts;
  float spacing = 0;  ///< the smallest, m
  double time = 0;
  std::int64_t frame = 0;
};

class VolumeExport final : public Observer {
 public:
  explicit VolumeExport(fs::path folder) : folder_(std::move(folder)) {}

  std::string name() const override { return kOption; }

  void begin(Simulation& simulation) override {
    std::error_code error;
    if (!fs::is_directory(folder_, error)) fs::create_directory(folder_, error);
    if (error) throw ioError("the folder cannot be made: " + error.message()).at({.file = folder_.string()});
    voxel_ = static_cast<const VolumeSettings&>(*simulation.scene().sections.at(kOption)).voxel;
    for (const auto& [node, output] : outputsOf<Particles>(simulation.scene().graph))
      sources_.push_back(output);
    if (sources_.empty())
      throw ioError("there is no volume to export: the scene has no particles",
                    "a scene with a ParticleFluid, or another node that puts out Particles")
          .at({.file = folder_.string()});
  }

  std::unique_ptr<Snapshot> capture(Simulation& simulation, std::unique_ptr<Snapshot> used) override {
    std::unique_ptr<VolumeSnapshot> to(static_cast<VolumeSnapshot*>(used.release()));
    if (!to) to = std::make_unique<VolumeSnapshot>();
    to->time = simulation.time();
    to->frame = simulation.frame();
    to->spacing = std::numeric_limits<float>::max();
    // A node may hand on particles that it got; they count once.
    std::vector<const ParticleSet*> seen;
    for (const Output<Particles>* output : sources_) {
      const Particles& source = **output;
      if (!source.exist() || std::count(seen.begin(), seen.end(), &source.set()) > 0) continue;
      if (to->parts.size() == seen.size()) to->parts.emplace_back(simulation.device());
      start(source, to->parts[seen.size()]);
      seen.push_back(&source.set());
      to->spacing = std::min(to->spacing, source.material.spacing);
    }
    return to;
  }

  void write(Snapshot& snapshot) override {
    auto& from = static_cast<VolumeSnapshot&>(snapshot);
    std::vector<ParticleVolume> fluids;
    for (VolumeSnapshot::Part& part : from.parts)
      fluids.push_back({part.positions.wait(), part.volume, part.volumes.wait()});
    writeDensity(folder_ / fmt::format("frame_{:05}.vdb", from.frame), fluids, voxel_ * from.spacing,
                 from.time);
  }

  void end(Simulation&, RunEnd) override {}

 private:
  static void start(const Particles& source, VolumeSnapshot::Part& part) {
    const std::int64_t count = source.set().refreshCount();
    part.positions.resize(count);
    part.positions.start(0, source.set().positions().read().data(), count);
    const Attribute<const float> own = source.ownValues(source.material.volume);
    part.volumes.resize(own ? count : 0);
    if (own) part.volumes.start(0, own.read().data(), count);
    part.volume = source.material.volume.value;
  }

  fs::path folder_;
  float voxel_ = 0;  // spacings
  std::vector<const Output<Particles>*> sources_;
};

}  // namespace

std::vector<OutputOption> VolumeExportKind::options() const {
  return {{.name = kOption,
           .argument = "DIR",
           .extensions = {},
           .doc = "Write the volume of the fluids at each frame as an OpenVDB file into a folder"}};
}

std::unique_ptr<Observer> VolumeExportKind::create(const OutputPaths& paths) const {
  return std::make_unique<VolumeExport>(paths.at(kOption));
}

}  // namespace weir
