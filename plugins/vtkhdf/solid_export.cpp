#include "plugins/vtkhdf/solid_export.h"

#include <algorithm>

#include "framework/graph/outputs_of.h"
#include "framework/solids/motion_of.h"

namespace weir {

namespace {

constexpr const char* kOptionName = "export-solids";

}  // namespace

/// Where the solids were, and are.
struct SolidExport::Frame final : Snapshot {
  double time = 0, since = 0;  // s; what has passed since the frame before
  std::vector<Pose> before, now;
  std::vector<Vec3f> vertices, velocities;
};

void SolidExport::begin(Simulation& simulation) {
  if (outputsOf<TriangleMesh>(simulation.scene().graph).empty())
    throw ioError("there is no solid to export: the scene has no mesh",
                  "a scene with a RigidBody or another mesh")
        .at({.file = file_.path().string()});
  file_.begin(simulation);
  sources_.clear(), indices_.clear(), triangles_.clear();
}

void SolidExport::collect(const Simulation& simulation) {
  for (const auto& [_, output] : outputsOf<TriangleMesh>(simulation.scene().graph))
    for (const MovedMesh& moved : movedMeshes(*output))
      sources_.push_back({moved.name, &**output, moved.motion});
  for (std::size_t k = 0; k < sources_.size(); ++k) {
    const auto at = static_cast<int>(indices_.size());
    indices_.insert(indices_.end(), sources_[k].mesh->vertices.size(), static_cast<std::int32_t>(k));
    for (const Vec3i& t : sources_[k].mesh->triangles) triangles_.push_back(t + Vec3i{at, at, at});
  }
}

void SolidExport::save(const StateWriter& to) {
  if (!file_.isOpen()) openFile();  // no frame since the run was resumed
  file_.save(to);
}

void SolidExport::resume(Simulation& simulation, const StateReader& from) {
  begin(simulation);
  file_.resume(from);
}

std::unique_ptr<Snapshot> SolidExport::capture(Simulation& simulation, std::unique_ptr<Snapshot> used) {
  if (sources_.empty()) collect(simulation);  // meshes are there once the run has been set up
  if (!used) used = std::make_unique<Frame>();
  Frame& frame = static_cast<Frame&>(*used);
  frame.time = simulation.time();
  const double before = std::max(0.0, frame.time - 1 / simulation.scene().world.frameRate.get());
  frame.since = frame.time - before;
  frame.before.clear(), frame.now.clear();
  for (const Source& source : sources_) {
    frame.now.push_back(source.motion != nullptr ? source.motion->poseAt(frame.time) : Pose{});
    frame.before.push_back(source.motion != nullptr ? source.motion->poseAt(before) : Pose{});
  }
  return used;
}

void SolidExport::write(Snapshot& snapshot) {
  if (!file_.isOpen()) openFile();
  Frame& frame = static_cast<Frame&>(snapshot);
  frame.vertices.clear(), frame.velocities.clear();
  const float rate = frame.since > 0 ? static_cast<float>(1 / frame.since) : 0.0f;
  for (std::size_t k = 0; k < sources_.size(); ++k)
    for (const Vec3f& vertex : sources_[k].mesh->vertices) {
      frame.vertices.push_back(frame.now[k].toWorld(vertex));
      frame.velocities.push_back(rate * (frame.vertices.back() - frame.before[k].toWorld(vertex)));
    }
  file_.writer().append({.time = frame.time,
                         .positions = frame.vertices,
                         .attributes = {flat(frame.velocities), std::span<const std::int32_t>(indices_)},
                         .fields = {static_cast<double>(sources_.size())},
                         .triangles = triangles_});
}

void SolidExport::openFile() {
  std::vector<std::string> names;
  for (const Source& source : sources_) names.push_back(source.name);
  file_.open(
      {.attributes = {{.name = "velocity", .components = 3, .type = VtkHdfType::kFloat32, .unit = "m/s"},
                      {.name = kSolidIndexName, .type = VtkHdfType::kInt32, .unit = {}}},
       .fields = {"solids"},
       .triangles = true},
      file_.texts("solids", names));
}

void SolidExport::end(Simulation&, RunEnd) {
  file_.close();
}

std::vector<OutputOption> SolidExportKind::options() const {
  return {
      {.name = kOptionName,
       .argument = "FILE.vtkhdf",
       .extensions = {".vtkhdf"},
       .doc =
           "Write the surfaces of solids and bodies, where they are at every frame, for ParaView and VTK"}};
}

std::unique_ptr<Observer> SolidExportKind::create(const OutputPaths& paths) const {
  return std::make_unique<SolidExport>(paths.at(kOptionName));
}

}  // namespace weir
