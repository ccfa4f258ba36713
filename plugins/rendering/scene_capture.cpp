#include "plugins/rendering/scene_capture.h"

#include <algorithm>

#include "framework/base/text.h"
#include "nodes/emitters/nozzle_emitter.h"
#include "nodes/particle_fluid/particle_fluid.h"
#include "nodes/solids/solid.h"
#include "nodes/static_boundary/static_boundary.h"
#include "plugins/rendering/plot_history.h"
#include "plugins/rendering/shape_geometry.h"

namespace weir::rendering {

namespace {

/// The outputs of all nodes that carry T, with the nodes' names.
template <class T>
std::vector<std::pair<std::string, const Output<T>*>> outputsOf(const Simulation& simulation) {
  std::vector<std::pair<std::string, const Output<T>*>> found;
  for (const auto& node : simulation.scene().graph.nodes())
    for (const OutputPort* output : node->outputs())
      if (output->typeName() == T::kPortType)
        found.emplace_back(node->name(), static_cast<const Output<T>*>(output));
  return found;
}

/// What moves the mesh of an output: the first node that takes it and is a motion, or null. Plugins bring
/// such nodes, too.
const RigidMotion* motionOf(const OutputPort* mesh) {
  for (const InputPort* input : mesh->links())
    if (const auto* motion = dynamic_cast<const RigidMotion*>(&input->node())) return motion;
  return nullptr;
}

Error unknownQuantity(const ParticleSet& particles, const std::string& name) {
  std::vector<std::string> names{"speed", "none"};
  for (const AttributeInfo& info : particles.attributes()) names.push_back(info.name);
  Error e = sceneError("the particles have no attribute " + inQuotes(name), joinNames(names),
                       didYouMean(name, names));
  return e.at({.pointer = "/render/color/by"});
}

template <class T>
void start(HostCopy<T>& copy, const Array<T>& from, std::int64_t count) {
  copy.resize(count);
  copy.start(0, from.data(), count);
}

/// Asks for the numbers that colour the particles; returns their unit.
std::string startColors(const ParticleSet& particles, const std::string& name, std::int64_t count,
                        FluidSnapshot& to) {
  if (name == "speed") {
    to.colorType = AttributeType::kVec3;
    start(to.vectors, particles.velocities(), count);
    return "m/s";
  }
  const AttributeInfo* info = particles.find(name);
  if (info == nullptr) throw unknownQuantity(particles, name);
  to.colorType = info->type;
  switch (info->type) {
    case AttributeType::kFloat:
      start(to.floats, particles.get<float>(name), count);
      break;
    case AttributeType::kVec3:
      start(to.vectors, particles.get<Vec3f>(name), count);
      break;
    case AttributeType::kInt:
      start(to.ints, particles.get<int>(name), count);
      break;
  }
  return info->unit;
}

}  // namespace

std::unique_ptr<SceneSnapshot> SceneCapture::at(Simulation& simulation, std::unique_ptr<SceneSnapshot> used) {
  std::unique_ptr<SceneSnapshot> snapshot = used ? std::move(used) : std::make_unique<SceneSnapshot>();
  snapshot->still = collected_ ? nullptr : collectStill(simulation);
  snapshot->time = simulation.time();
  captureFluids(simulation, *snapshot);
  snapshot->particles = simulation.particleCount();
  snapshot->plotted = plottedNumbers(settings_.plots, simulation);
  snapshot->poses.clear();
  for (const RigidMotion* motion : motions_)
    snapshot->poses.push_back(motion != nullptr ? motion->poseAt(simulation.time()) : Pose{});
  return snapshot;
}

std::unique_ptr<StillScene> SceneCapture::collectStill(const Simulation& simulation) {
  collected_ = true;
  checkNames(simulation);
  auto still = std::make_unique<StillScene>();
  for (const auto& [node, output] : outputsOf<TriangleMesh>(simulation))
    addSurface(**output, node, motionOf(output), *still);
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
  if (puts(outputsOf<Fluid>(simulation)) || puts(outputsOf<TriangleMesh>(simulation))) return;
  throw sceneError("the node " + inQuotes(followed) + " cannot be followed: it has no fluid and no mesh",
                   "a node that puts out a Fluid or a mesh")
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

const SurfaceSettings* SceneCapture::settingsOf(const std::string& node) const {
  for (std::size_t i = 0; i < settings_.surfaces.size(); ++i)
    if (*settings_.surfaces[i].node == node) return &settings_.surfaces[i];
  return nullptr;
}

void SceneCapture::addSurface(const TriangleMesh& mesh, const std::string& node, const RigidMotion* motion,
                              StillScene& still) {
  const SurfaceSettings* own = settingsOf(node);
  if (mesh.empty() || (own != nullptr && !own->visible)) return;
  const Pose start = motion != nullptr ? motion->poseAt(0) : Pose{};
  for (const Vec3f& vertex : mesh.vertices) still.bounds.extend(start.toWorld(vertex));
  static const SurfaceSettings kUsual;
  const SurfaceSettings& look = own != nullptr ? *own : kUsual;
  still.surfaces.push_back({.node = node, .mesh = mesh, .look = look.look, .color = look.shownColor()});
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
    addSurface(meshOfShape(shape), node, nullptr, still);
    return;
  }
  for (const Line& line : outlineOfShape(shape)) {
    still.bounds.extend(line.from);
    if (settings_.outlines) still.lines.insert(still.lines.end(), {line.from, line.to});
  }
}

void SceneCapture::captureFluids(const Simulation& simulation, SceneSnapshot& snapshot) const {
  const std::string& by = settings_.color->by;
  std::size_t i = 0;
  for (const auto& [node, output] : outputsOf<Fluid>(simulation)) {
    const Fluid& fluid = **output;
    const std::int64_t count = fluid.particles->refreshCount();
    if (i == snapshot.fluids.size()) snapshot.fluids.emplace_back(simulation.device());
    FluidSnapshot& to = snapshot.fluids[i++];
    to.node = node;
    to.spacing = fluid.constants->spacing;
    start(to.positions, fluid.particles->positions(), count);
    if (settings_.arrows->spacing.get()) start(to.velocities, fluid.particles->velocities(), count);
    if (by != "none") snapshot.colorUnit = startColors(*fluid.particles, by, count, to);
  }
}

}  // namespace weir::rendering
