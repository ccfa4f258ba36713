#include "plugins/vtkhdf/surface_export.h"

#include "framework/graph/outputs_of.h"

namespace weir {

namespace {

constexpr const char* kOptionName = "export-surface";

}  // namespace

/// The surfaces, one behind the other.
class SurfaceExport::Frame final : public Snapshot {
 public:
  Frame(std::size_t surfaces, Device& device) {
    for (std::size_t i = 0; i < surfaces; ++i) copies_.emplace_back(device);
  }

  void start(const std::vector<Source>& sources, double time) {
    time_ = time;
    for (std::size_t i = 0; i < sources.size(); ++i) copies_[i].start(**sources[i].mesh);
  }

  /// Waits until all has arrived.
  VtkHdfFrame finish() {
    VtkHdfFrame frame{.time = time_, .positions = {}, .attributes = {}, .fields = {}, .triangles = {}};
    if (copies_.size() == 1) {
      const MeshSpan mesh = copies_.front().wait();
      frame.positions = mesh.vertices;
      frame.attributes = {flat(mesh.normals)};
      frame.triangles = mesh.triangles;
    } else {
      joinAll();
      frame.positions = vertices_;
      frame.attributes = {flat(normals_), std::span<const std::int32_t>(indices_)};
      frame.triangles = triangles_;
    }
    frame.fields = {static_cast<double>(frame.triangles.size())};
    return frame;
  }

 private:
  void joinAll() {
    vertices_.clear(), normals_.clear(), indices_.clear(), triangles_.clear();
    for (std::size_t i = 0; i < copies_.size(); ++i) {
      const MeshSpan mesh = copies_[i].wait();
      const auto first = static_cast<int>(vertices_.size());
      vertices_.insert(vertices_.end(), mesh.vertices.begin(), mesh.vertices.end());
      normals_.insert(normals_.end(), mesh.normals.begin(), mesh.normals.end());
      indices_.insert(indices_.end(), mesh.vertices.size(), static_cast<int>(i));
      for (const Vec3i& t : mesh.triangles) triangles_.push_back(t + Vec3i{first, first, first});
    }
  }

  double time_ = 0;
  std::vector<DynamicMeshCopy> copies_;
  // Only if there are several surfaces.
  std::vector<Vec3f> vertices_, normals_;
  std::vector<std::int32_t> indices_;
  std::vector<Vec3i> triangles_;
};

void SurfaceExport::begin(Simulation& simulation) {
  sources_.clear();
  for (const auto& [node, output] : outputsOf<DynamicMesh>(simulation.scene().graph))
    sources_.push_back({node, output});
  if (sources_.empty())
    throw ioError("there is no surface to export: the scene has no FluidSurface",
                  "a scene with a FluidSurface, or another node that puts out a DynamicMesh",
                  "--export writes the particles")
        .at({.file = file_.path().string()});
  file_.begin(simulation);
}

void SurfaceExport::save(const StateWriter& to) {
  if (!file_.isOpen()) openFile();  // no frame since the run was resumed
  file_.save(to);
}

void SurfaceExport::resume(Simulation& simulation, const StateReader& from) {
  begin(simulation);
  file_.resume(from);
}

std::unique_ptr<Snapshot> SurfaceExport::capture(Simulation& simulation, std::unique_ptr<Snapshot> used) {
  if (!used) used = std::make_unique<Frame>(sources_.size(), simulation.device());
  static_cast<Frame&>(*used).start(sources_, simulation.time());
  return used;
}

void SurfaceExport::write(Snapshot& snapshot) {
  if (!file_.isOpen()) openFile();
  file_.writer().append(static_cast<Frame&>(snapshot).finish());
}

void SurfaceExport::openFile() {
  VtkHdfLayout layout{
      .attributes = {{.name = "Normals", .components = 3, .type = VtkHdfType::kFloat32, .unit = {}}},
      .fields = {"triangles"},
      .triangles = true};
  if (sources_.size() > 1)
    layout.attributes.push_back({.name = kSurfaceIndexName, .type = VtkHdfType::kInt32, .unit = {}});
  std::vector<std::string> names;
  for (const Source& source : sources_) names.push_back(source.node);
  file_.open(std::move(layout), file_.texts("surfaces", names));
}

void SurfaceExport::end(Simulation&, RunEnd) {
  file_.close();
}

std::vector<OutputOption> SurfaceExportKind::options() const {
  return {{.name = kOptionName,
           .argument = "FILE.vtkhdf",
           .extensions = {".vtkhdf"},
           .doc = "Write the surfaces of fluids (FluidSurface) of every frame, for ParaView and VTK"}};
}

std::unique_ptr<Observer> SurfaceExportKind::create(const OutputPaths& paths) const {
  return std::make_unique<SurfaceExport>(paths.at(kOptionName));
}

}  // namespace weir
