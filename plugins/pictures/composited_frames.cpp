#include "plugins/pictures/composited_frames.h"

#include <algorithm>

#include "framework/graph/outputs_of.h"
#include "framework/particles/owned_particles.h"
#include "framework/solids/motion_of.h"
#include "nodes/static_boundary/static_boundary.h"
#include "nodes/white_water/white_water.h"
#include "plugins/views/shape_geometry.h"

namespace weir::rendering {

namespace {

/// Null where nothing is said of the node.
const SurfaceSettings* surfaceOf(const RenderSettings& settings, const std::string& node) {
  for (std::size_t i = 0; i < settings.surfaces.size(); ++i)
    if (*settings.surfaces[i].node == node) return &settings.surfaces[i];
  return nullptr;
}

bool isShown(const SurfaceSettings* surface) {
  return surface == nullptr || surface->visible;
}

/// Or could be: meshes are not there yet.
bool showsMeshes(const RenderSettings& settings, const SceneGraph& graph) {
  for (const auto& [node, output] : outputsOf<TriangleMesh>(graph))
    for (const MovedMesh& moved : movedMeshes(*output)) {
      const SurfaceSettings* const own = surfaceOf(settings, moved.name);
      if (isShown(own != nullptr ? own : surfaceOf(settings, node))) return true;
    }
  const auto meshes = outputsOf<DynamicMesh>(graph);
  return std::any_of(meshes.begin(), meshes.end(),
                     [&](const auto& mesh) { return isShown(surfaceOf(settings, mesh.first)); });
}

/// Of an outline, as many as one of any size has.
std::size_t linesOf(BoundaryShape shape) {
  switch (shape) {
    case BoundaryShape::kNone:
    case BoundaryShape::kPlane:
      return 0;
    case BoundaryShape::kBox:
      return outlineOfShape({.kind = ShapeKind::kBox}).size();
    case BoundaryShape::kSphere:
      return outlineOfShape({.kind = ShapeKind::kSphere}).size();
    case BoundaryShape::kCylinder:
      return outlineOfShape({.kind = ShapeKind::kCylinder}).size();
    case BoundaryShape::kCapsule:
      return outlineOfShape({.kind = ShapeKind::kCapsule}).size();
    case BoundaryShape::kCone:
      return outlineOfShape({.kind = ShapeKind::kCone}).size();
  }
  return 0;
}

/// Whether no boundary is shown as a solid; adds the lines of those that are containers.
bool areOutlines(const RenderSettings& settings, const SceneGraph& graph, std::size_t& lines) {
  for (const auto& node : graph.nodes()) {
    const auto* const boundary = dynamic_cast<const StaticBoundary*>(node.get());
    if (boundary == nullptr || linesOf(boundary->shape) == 0) continue;
    if (!isShown(surfaceOf(settings, node->name()))) continue;
    if (!boundary->inverted) return false;
    if (settings.outlines) lines += linesOf(boundary->shape);
  }
  return true;
}

/// White water is gathered in another order than rank by rank.
bool areSharedSpheres(const RenderSettings& settings, const SceneGraph& graph) {
  for (const auto& [node, output] : outputsOf<Particles>(graph)) {
    if (dynamic_cast<const OwnedParticles*>(&output->node()) == nullptr) return false;
    if (dynamic_cast<const WhiteWater*>(&output->node()) != nullptr) return false;
    for (std::size_t i = 0; i < settings.fluids.size(); ++i)
      if (*settings.fluids[i].node == node && settings.fluids[i].look == FluidLook::kWater) return false;
  }
  return true;
}

bool followsNothing(const RenderSettings& settings) {
  bool follows = !settings.camera->follow->empty();
  for (std::size_t i = 0; i < settings.cameras.size(); ++i)
    follows = follows || !settings.cameras[i].follow->empty();
  return !follows;
}

}  // namespace

bool canBeComposited(const Scene& scene) {
  const auto& settings = static_cast<const RenderSettings&>(*scene.sections.at("render"));
  std::size_t lines = 0;
  if (settings.engine != PictureEngine::kWeir || settings.arrows->spacing.get() ||
      !followsNothing(settings) || showsMeshes(settings, scene.graph) ||
      !areSharedSpheres(settings, scene.graph) || !areOutlines(settings, scene.graph, lines))
    return false;
  const std::vector<Vec3f> ends(2 * lines);
  View view{.lines = {{.points = ends}}};
  SceneView::addEnvironment(settings, view);
  return ComputeRenderer::canDraw(view);
}

CompositedFrames::CompositedFrames(const RenderSettings& settings, const Simulation& simulation,
                                   Communicator& ranks)
    : ranks_(ranks), device_(siblingOf(simulation.device())), capture_(settings, {.ranks = &ranks}) {
  cameras_.push_back(std::make_unique<SceneView>(settings, *settings.camera, renderer_, &ranks));
  for (std::size_t i = 0; i < settings.cameras.size(); ++i)
    cameras_.push_back(std::make_unique<SceneView>(settings, settings.cameras[i], renderer_, &ranks));
}

std::unique_ptr<Snapshot> CompositedFrames::at(Simulation& simulation) {
  own_ = capture_.at(simulation, std::move(own_));
  auto frame = std::make_unique<CompositedFrame>();
  for (const auto& camera : cameras_) frame->pictures.push_back(pictureOf(*camera));
  if (ranks_.rank() > 0) return nullptr;
  frame->scene.frame = own_->frame;
  frame->scene.time = own_->time;
  frame->scene.particles = own_->particles;
  frame->scene.plotted = own_->plotted;
  return frame;
}

CompositedFrame::Picture CompositedFrames::pictureOf(SceneView& camera) {
  CompositedFrame::Picture picture{.view = camera.of(*own_), .key = camera.colorKey(), .seen = {}};
  picture.seen = renderer_.seenOf(picture.view, ranks_);
  picture.view.particles.clear();
  return picture;
}

}  // namespace weir::rendering
