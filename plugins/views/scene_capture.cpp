#include "plugins/views/scene_capture.h"

#include <algorithm>
#include <cmath>

#include "framework/base/text.h"
#include "framework/graph/outputs_of.h"
#include "framework/particles/owned_particles.h"
#include "framework/particles/particles.h"
#include "framework/solids/motion_of.h"
#include "nodes/emitters/nozzle_emitter.h"
#include "nodes/fluid_surface/fluid_surface.h"
#include "nodes/static_boundary/static_boundary.h"
#include "nodes/white_water/white_water.h"
#include "plugins/views/frame_kernels.h"
#include "plugins/views/plot_history.h"
#include "plugins/views/shape_geometry.h"

namespace weir::rendering {

namespace {

/// Passes of a mesh's smoothing that halve waves of that many spacings: those of 2·√passes cells.
int passesFor(float spacings) {
  const float root = spacings / (2 * FluidMeshSettings{}.cellSize);
  return static_cast<int>(std::lround(root * root));
}

Error unknownQuantity(const ParticleSet& particles, const std::string& name, const std::string& pointer) {
  std::vector<std::string> names{"speed", "none"};
  for (const AttributeInfo& info : particles.attributes()) names.push_back(info.name);
  Error e = sceneError("the particles have no attribute " + inQuotes(name), joinNames(names),
                       didYouMean(name, names));
  return e.at({.pointer = pointer});
}

/// Asks for the numbers that colour the particles; returns their unit. `pointer`: where the scene file says
/// which.
std::string startColors(const ParticleSet& particles, const std::string& name, const std::string& pointer,
                        std::int64_t count, FluidSnapshot& to) {
  if (name == "speed") {
    to.colorType = AttributeType::kVec3;
    to.numbers<Vec3f>().start(particles.velocities().read(), count);
    return "m/s";
  }
  const AttributeInfo* info = particles.find(name);
  if (info == nullptr) throw unknownQuantity(particles, name, pointer);
  to.colorType = info->type;
  withAttributeType(info->type, [&]<class T>(std::type_identity<T>) {
    to.numbers<T>().start(particles.get<T>(name).read(), count);
  });
  return info->unit;
}

/// Of white water, its sizes and kinds. Other white particles have none.
void startWhite(const ParticleSet& particles, std::int64_t count, FluidSnapshot& to) {
  const auto has = [&](const char* name, AttributeType type) {
    const AttributeInfo* info = particles.find(name);
    return info != nullptr && info->type == type;
  };
  to.kinds = false;
  if (!has("radius", AttributeType::kFloat)) return;
  to.colorType = AttributeType::kFloat;
  to.numbers<float>().start(particles.get<float>("radius").read(), count);
  to.kinds = has("type", AttributeType::kInt);
  if (to.kinds) to.numbers<int>().start(particles.get<int>("type").read(), count);
}

/// The particles that a node takes, whose surface it puts out; null if there are none.
const Particles* fluidBehind(const Node& node) {
  for (const InputPort* input : node.inputs())
    if (input->typeName() == Particles::kPortType && !input->links().empty())
      return &**static_cast<const Output<Particles>*>(input->links().front());
  return nullptr;
}

}  // namespace

bool isWhite(const RenderSettings& settings, const Node& node) {
  for (std::size_t i = 0; i < settings.fluids.size(); ++i)
    if (*settings.fluids[i].node == node.name()) return settings.fluids[i].look == FluidLook::kWhite;
  return dynamic_cast<const WhiteWater*>(&node) != nullptr;
}

std::unique_ptr<SceneSnapshot> SceneCapture::at(Simulation& simulation, std::unique_ptr<SceneSnapshot> used) {
  std::unique_ptr<SceneSnapshot> snapshot = used ? std::move(used) : std::make_unique<SceneSnapshot>();
  snapshot->still = collected_ ? nullptr : collectStill(simulation);
  snapshot->frame = simulation.frame();
  snapshot->time = simulation.time();
  captureFluidSurfaces(simulation, *snapshot);
  captureFluids(simulation, *snapshot);
  snapshot->plotted = plottedNumbers(settings_.plots, simulation);
  const double before = std::max(0.0, simulation.time() - 1 / simulation.scene().world.frameRate.get());
  const auto poseAt = [](const RigidMotion* motion, double time) {
    return motion != nullptr ? motion->poseAt(time) : Pose{};
  };
  snapshot->poses.clear(), snapshot->posesBefore.clear();
  for (const RigidMotion* motion : motions_) {
    snapshot->poses.push_back(poseAt(motion, simulation.time()));
    snapshot->posesBefore.push_back(poseAt(motion, before));
  }
  return snapshot;
}

std::shared_ptr<const StillScene> SceneCapture::collectStill(const Simulation& simulation) {
  collected_ = true;
  checkNames(simulation);
  auto still = std::make_shared<StillScene>();
  for (const auto& [node, output] : outputsOf<TriangleMesh>(simulation.scene().graph))
    for (const MovedMesh& moved : movedMeshes(*output)) addSurface(**output, node, moved, *still);
  for (const auto& node : simulation.scene().graph.nodes()) {
    const auto* boundary = dynamic_cast<const StaticBoundary*>(node.get());
    if (boundary != nullptr && boundary->shape != BoundaryShape::kNone)
      addShape(boundary->boundary->pieces.front().shape, node->name(), *still);
    if (const auto* emitter = dynamic_cast<const NozzleEmitter*>(node.get()))
      still->bounds.extend(emitter->position);
  }
  return still;
}

void SceneCapture::checkNames(const Simulation& simulation) const {
  for (std::size_t i = 0; i < settings_.fluids.size(); ++i)
    checkName(simulation, settings_.fluids[i].node, "/render/fluids/" + std::to_string(i) + "/node");
  for (std::size_t i = 0; i < settings_.surfaces.size(); ++i)
    checkName(simulation, settings_.surfaces[i].node, "/render/surfaces/" + std::to_string(i) + "/node");
  checkFollowed(simulation, settings_.camera->follow, "/render/camera/follow");
  for (std::size_t i = 0; i < settings_.cameras.size(); ++i)
    checkFollowed(simulation, settings_.cameras[i].follow,
                  "/render/cameras/" + std::to_string(i) + "/follow");
}

void SceneCapture::checkFollowed(const Simulation& simulation, const std::string& followed,
                                 const std::string& pointer) {
  if (followed.empty()) return;
  checkName(simulation, followed, pointer);
  const auto puts = [&](const auto& outputs) {
    return std::any_of(outputs.begin(), outputs.end(),
                       [&](const auto& output) { return output.first == followed; });
  };
  const SceneGraph& graph = simulation.scene().graph;
  if (puts(outputsOf<Particles>(graph)) || puts(outputsOf<TriangleMesh>(graph))) return;
  for (const auto& [_, output] : outputsOf<TriangleMesh>(graph))
    for (const MovedMesh& moved : movedMeshes(*output))
      if (moved.name == followed) return;
  throw sceneError("the node " + inQuotes(followed) + " cannot be followed: it has no particles and no mesh",
                   "a node that puts out Particles or a mesh")
      .at({.file = simulation.scene().file, .pointer = pointer});
}

void SceneCapture::checkName(const Simulation& simulation, const std::string& name,
                             const std::string& pointer) {
  if (simulation.scene().graph.find(name) != nullptr) return;
  std::vector<std::string> names;
  for (const auto& node : simulation.scene().graph.nodes()) names.push_back(node->name());
  Error e = sceneError("the scene has no node " + inQuotes(name), joinNames(names), didYouMean(name, names));
  throw e.at({.file = simulation.scene().file, .pointer = pointer});
}

std::size_t SceneCapture::placeOfFluid(const std::string& node) const {
  std::size_t i = 0;
  while (i < settings_.fluids.size() && *settings_.fluids[i].node != node) ++i;
  return i;
}

const SurfaceSettings* SceneCapture::settingsOf(const std::string& node) const {
  for (std::size_t i = 0; i < settings_.surfaces.size(); ++i)
    if (*settings_.surfaces[i].node == node) return &settings_.surfaces[i];
  return nullptr;
}

void SceneCapture::addSurface(const TriangleMesh& mesh, const std::string& node, const MovedMesh& moved,
                              StillScene& still) {
  const RigidMotion* const motion = moved.motion;
  const SurfaceSettings* own = settingsOf(moved.name);
  if (own == nullptr) own = settingsOf(node);
  if (mesh.empty() || (own != nullptr && !own->visible)) return;
  const Pose start = motion != nullptr ? motion->poseAt(0) : Pose{};
  for (const Vec3f& vertex : mesh.vertices) still.bounds.extend(start.toWorld(vertex));
  static const SurfaceSettings kUsual;
  const SurfaceSettings& look = own != nullptr ? *own : kUsual;
  still.surfaces.push_back(
      {.node = moved.name, .from = node, .mesh = mesh, .look = look.look, .color = look.shownColor()});
  if (look.look == SurfaceLook::kWater) still.surfaces.back().water = waterView(*look.water, 0, 0);
  motions_.push_back(motion);
}

void SceneCapture::addShape(const Shape& shape, const std::string& node, StillScene& still) {
  const SurfaceSettings* own = settingsOf(node);
  if (own != nullptr && !own->visible) return;
  if (shape.kind == ShapeKind::kPlane) {
    // A floor is the ground; walls without an end would hide the scene.
    constexpr float kLevel = 0.999f;
    still.floor = std::nullopt;
    if (rotate(shape.rotation, {0, 1, 0}).y > kLevel) still.floor = shape.position.y;
    return;
  }
  if (!shape.inverted) {
    addSurface(meshOfShape(shape), node, {node, nullptr}, still);
    return;
  }
  for (const Line& line : outlineOfShape(shape)) {
    still.bounds.extend(line.from);
    if (settings_.outlines) still.lines.insert(still.lines.end(), {line.from, line.to});
  }
}

void SceneCapture::captureFluids(const Simulation& simulation, SceneSnapshot& snapshot) const {
  std::size_t i = 0;
  snapshot.particles = 0;
  for (const auto& [node, output] : outputsOf<Particles>(simulation.scene().graph)) {
    if (!(*output)->exist()) continue;
    ParticleSet& particles = particlesOf(*output);
    const std::int64_t count = particles.refreshCount();
    snapshot.particles += count;
    if (!showsParticles(*output)) continue;
    if (i == snapshot.fluids.size())
      snapshot.fluids.emplace_back(simulation.device(), needs_.ranks != nullptr);
    FluidSnapshot& to = snapshot.fluids[i++];
    if (isClosedWater(node)) {
      captureSpray(node, **output, to);
      continue;
    }
    to.node = node;
    to.spacing = (*output)->material.spacing;
    to.positions.start(particles.positions().read(), count);
    if (settings_.arrows->spacing.get() || needs_.velocities)
      to.velocities.start(particles.velocities().read(), count);
    const std::size_t place = placeOfFluid(node);
    to.look = place < settings_.fluids.size() ? &settings_.fluids[place] : nullptr;
    to.white = isWhite(settings_, output->node());
    to.colorType = std::nullopt;
    if (to.white) {
      startWhite(particles, count, to);
      continue;
    }
    if (to.look != nullptr && to.look->look == FluidLook::kWater) {
      const std::string& by = to.look->foam->by;
      if (by != "none")
        startColors(particles, by, "/render/fluids/" + std::to_string(place) + "/foam/by", count, to);
    } else if (const std::string& by = settings_.color->by; by != "none") {
      snapshot.colorUnit = startColors(particles, by, "/render/color/by", count, to);
    }
  }
  if (needs_.ranks != nullptr) snapshot.particles = needs_.ranks->sum(snapshot.particles);
}

ParticleSet& SceneCapture::particlesOf(Output<Particles>& output) const {
  auto* const shared = needs_.ranks != nullptr ? dynamic_cast<OwnedParticles*>(&output.node()) : nullptr;
  return shared != nullptr ? shared->owned() : output->set();
}

/// Of the surface that was made of the fluid.
void SceneCapture::captureSpray(const std::string& node, const Particles& fluid, FluidSnapshot& to) const {
  const Spray& spray = ownSurfaces_.at(node).mesher.spray();
  to.node = node + " spray";
  // So that drops are drawn half as large as they are, as foam is (shownShareOf).
  constexpr float kHalf = shownShareOf(WhiteKind::kSpray) / shownShareOf(WhiteKind::kFoam);
  to.spacing = 2 * kHalf * Spray::meanRadius() * fluid.material.spacing;
  to.look = nullptr;
  to.white = true;
  to.kinds = false;
  to.colorType = AttributeType::kFloat;
  to.positions.start(spray.positions(), spray.size());
  to.numbers<float>().start(spray.radii(), spray.size());
  if (needs_.velocities) to.velocities.start(spray.velocities(), spray.size());
}

void SceneCapture::captureFluidSurfaces(const Simulation& simulation, SceneSnapshot& snapshot) {
  std::size_t i = 0;
  for (const auto& [node, output] : outputsOf<DynamicMesh>(simulation.scene().graph)) {
    const SurfaceSettings* own = settingsOf(node);
    if (own != nullptr && !own->visible) continue;
    if (i == snapshot.fluidSurfaces.size()) snapshot.fluidSurfaces.emplace_back(simulation.device());
    FluidSurfaceSnapshot& to = snapshot.fluidSurfaces[i++];
    const Particles* fluid = fluidBehind(output->node());
    const auto* surface = dynamic_cast<const FluidSurface*>(&output->node());
    // Nodes do nothing in a replay.
    const bool made = simulation.isReplay() && surface != nullptr && fluid != nullptr && fluid->exist();
    captureMesh(made ? meshOf(node, *fluid, surface->meshSettings()) : **output, fluid, to);
    to.node = node;
    to.look = own != nullptr ? own->look.get() : SurfaceLook::kMatt;
    to.color = own != nullptr && own->color.get() ? *own->color.get() : settings_.color->fixed.get();
    if (own != nullptr && own->particleColors) captureColors(snapshot, fluid, to.fluid);
    to.water = std::nullopt;
    to.foamReach = 0;
    if (to.look == SurfaceLook::kWater) to.water = waterView(*own->water, 0, 0);
  }
  captureClosedWater(simulation, snapshot, i);
}

void SceneCapture::captureClosedWater(const Simulation& simulation, SceneSnapshot& snapshot,
                                      std::size_t first) {
  for (const auto& [node, output] : outputsOf<Particles>(simulation.scene().graph)) {
    if (!isClosedWater(node) || !(*output)->exist() || !showsParticles(*output)) continue;
    if (first == snapshot.fluidSurfaces.size()) snapshot.fluidSurfaces.emplace_back(simulation.device());
    FluidSurfaceSnapshot& to = snapshot.fluidSurfaces[first++];
    const bool leavesSpray = breaksUp((*output)->material.spacing);
    const FluidSettings& look = settings_.fluids[placeOfFluid(node)];
    captureMesh(
        meshOf(node, **output, {.meshSmoothing = passesFor(look.smoothing), .leavesSpray = leavesSpray}),
        &**output, to);
    to.node = node;
    to.look = SurfaceLook::kWater;
    to.color = settings_.color->fixed;
    to.water = waterView(*look.water, 0, 0);
    constexpr float kReach = 2;  // spacings: a few of what the mesh resolves
    to.foamReach = kReach * (*output)->material.spacing;
  }
}

void SceneCapture::captureMesh(const DynamicMesh& mesh, const Particles* fluid,
                               FluidSurfaceSnapshot& to) const {
  to.mesh.start(mesh);
  if (!needs_.velocities || fluid == nullptr || !fluid->exist()) return;
  ParticleSet& particles = fluid->set();
  const std::int64_t count = particles.refreshCount();
  to.fluid.positions.start(particles.positions().read(), count);
  to.fluid.velocities.start(particles.velocities().read(), count);
  to.fluid.spacing = fluid->material.spacing;
}

void SceneCapture::captureColors(SceneSnapshot& snapshot, const Particles* fluid, FluidSnapshot& to) const {
  const std::string& by = settings_.color->by;
  to.colorType = std::nullopt;
  if (by == "none" || fluid == nullptr || !fluid->exist()) return;
  ParticleSet& particles = fluid->set();
  const std::int64_t count = particles.refreshCount();
  to.positions.start(particles.positions().read(), count);
  to.spacing = fluid->material.spacing;
  snapshot.colorUnit = startColors(particles, by, "/render/color/by", count, to);
}

const DynamicMesh& SceneCapture::meshOf(const std::string& node, const Particles& fluid,
                                        const FluidMeshSettings& settings) {
  Device& device = fluid.set().device();
  auto found = ownSurfaces_.find(node);
  if (found == ownSurfaces_.end())
    found = ownSurfaces_
                .emplace(node, OwnSurface{FluidMesher(device, settings, fluid.material.spacing),
                                          {Array<Vec3f>(device), Array<Vec3f>(device), Array<Vec3i>(device)}})
                .first;
  found->second.mesher.make(fluid.set(), found->second.mesh);
  return found->second.mesh;
}

bool SceneCapture::isClosedWater(const std::string& node) const {
  const std::size_t place = placeOfFluid(node);
  return needs_.closedWater && place < settings_.fluids.size() &&
         settings_.fluids[place].look == FluidLook::kWater;
}

bool SceneCapture::showsParticles(const OutputPort& fluid) const {
  if (settings_.particles != ParticleDisplay::kAuto) return settings_.particles == ParticleDisplay::kAll;
  return std::none_of(fluid.links().begin(), fluid.links().end(), [this](const InputPort* input) {
    const Node& taker = input->node();
    const auto& outputs = taker.outputs();
    const SurfaceSettings* own = settingsOf(taker.name());
    return (own == nullptr || own->visible) &&
           std::any_of(outputs.begin(), outputs.end(),
                       [](const OutputPort* output) { return output->typeName() == DynamicMesh::kPortType; });
  });
}

}  // namespace weir::rendering
