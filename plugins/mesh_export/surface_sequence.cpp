#include "plugins/mesh_export/surface_sequence.h"

#include "framework/base/error.h"
#include "framework/graph/outputs_of.h"
#include "plugins/mesh_export/mesh_text.h"

namespace weir {

namespace {

constexpr const char* kPly = "ply";
constexpr const char* kObj = "obj";

}  // namespace

class SurfaceSequence::Frame final : public Snapshot {
 public:
  Frame(std::size_t meshes, Device& device) {
    for (std::size_t i = 0; i < meshes; ++i) copies.emplace_back(device);
  }

  std::int64_t number = 0;
  std::vector<DynamicMeshCopy> copies;  // in the order of the sources
};

void SurfaceSequence::begin(Simulation& simulation) {
  sources_.clear();
  for (const auto& [node, output] : outputsOf<DynamicMesh>(simulation.scene().graph))
    sources_.push_back({node, output});
  if (sources_.empty())
    throw ioError("there is no surface to write: the scene has no FluidSurface",
                  "a scene with a FluidSurface, or another node that puts out a DynamicMesh",
                  "--ply-particles writes the particles")
        .at({.file = paths_.begin()->second.string()});
  if (const auto path = paths_.find(kPly); path != paths_.end()) ply_.emplace(path->second, ".ply");
  if (const auto path = paths_.find(kObj); path != paths_.end()) obj_.emplace(path->second, ".obj");
}

std::unique_ptr<Snapshot> SurfaceSequence::capture(Simulation& simulation, std::unique_ptr<Snapshot> used) {
  if (!used) used = std::make_unique<Frame>(sources_.size(), simulation.device());
  auto& frame = static_cast<Frame&>(*used);
  frame.number = simulation.frame();
  for (std::size_t i = 0; i < sources_.size(); ++i) frame.copies[i].start(**sources_[i].mesh);
  return used;
}

void SurfaceSequence::write(Snapshot& snapshot) {
  auto& frame = static_cast<Frame&>(snapshot);
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    const MeshSpan mesh = frame.copies[i].wait();
    if (ply_) ply_->write(sources_[i].node, frame.number, plyOf(mesh));
    if (obj_) obj_->write(sources_[i].node, frame.number, objOf(mesh));
  }
}

std::vector<OutputOption> SurfaceSequenceKind::options() const {
  return {
      {kPly, "DIR", {}, "Write each frame's surfaces of fluids (FluidSurface) as PLY files into a folder"},
      {kObj, "DIR", {}, "The same as OBJ files"}};
}

std::unique_ptr<Observer> SurfaceSequenceKind::create(const OutputPaths& paths) const {
  return std::make_unique<SurfaceSequence>(paths);
}

}  // namespace weir
