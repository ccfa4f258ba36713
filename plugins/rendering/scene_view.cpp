#include "plugins/rendering/scene_view.h"

#include <algorithm>
#include <cmath>

#include "framework/base/text.h"
#include "nodes/emitters/nozzle_emitter.h"
#include "nodes/particle_fluid/particle_fluid.h"
#include "nodes/solids/solid.h"
#include "nodes/static_boundary/static_boundary.h"
#include "plugins/rendering/shape_geometry.h"

namespace weir::rendering {

namespace {

/// The outputs of all nodes that carry T, with the nodes' names.
template <class T>
std::vector<std::pair<std::string, Output<T>*>> outputsOf(const Simulation& simulation) {
  std::vector<std::pair<std::string, Output<T>*>> found;
  for (const auto& node : simulation.scene().graph.nodes())
    for (OutputPort* output : node->outputs())
      if (output->typeName() == T::kPortType)
        found.emplace_back(node->name(), static_cast<Output<T>*>(output));
  return found;
}

std::vector<float> lengthsOf(const std::vector<Vec3f>& vectors) {
  std::vector<float> lengths;
  lengths.reserve(vectors.size());
  for (const Vec3f& v : vectors) lengths.push_back(length(v));
  return lengths;
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

/// The numbers that colour the particles, and what they are.
std::vector<float> quantityOf(const ParticleSet& particles, const std::string& name, std::int64_t count,
                              ColorKey& key) {
  if (name == "speed") {
    key.unit = "m/s";
    return lengthsOf(particles.velocities().toHost(count));
  }
  const AttributeInfo* info = particles.find(name);
  if (info == nullptr) throw unknownQuantity(particles, name);
  key.unit = info->unit;
  switch (info->type) {
    case AttributeType::kFloat:
      return particles.get<float>(name).toHost(count);
    case AttributeType::kVec3:
      return lengthsOf(particles.get<Vec3f>(name).toHost(count));
    case AttributeType::kInt:
      break;
  }
  const std::vector<int> numbers = particles.get<int>(name).toHost(count);
  return {numbers.begin(), numbers.end()};
}

/// The next of 1, 2, 5, 10, … times a power of ten that is not below x > 0.
float roundUp(float x) {
  const float power = std::pow(10.0f, std::floor(std::log10(x)));
  for (const float step : {1.0f, 2.0f, 5.0f})
    if (step * power >= x) return step * power;
  return 10 * power;
}

}  // namespace

View SceneView::at(Simulation& simulation) {
  if (!collected_) collectStatic(simulation);
  View view;
  view.width = settings_.width;
  view.height = settings_.height;
  view.backgroundTop = settings_.backgroundTop;
  view.backgroundBottom = settings_.backgroundBottom;
  addFluids(simulation, view);
  view.surfaces = surfaces_;
  for (std::size_t i = 0; i < motions_.size(); ++i) {
    if (motions_[i] == nullptr) continue;
    const Pose pose = motions_[i]->poseAt(simulation.time());
    view.surfaces[i].rotation = pose.rotation;
    view.surfaces[i].position = pose.translation;
  }
  if (!lines_.empty()) view.lines.push_back({.points = lines_});
  const Aabb box = bounds_.empty() ? Aabb{{-1, -1, -1}, {1, 1, 1}} : bounds_;
  constexpr float kGroundShare = 4;  // of the size of the scene, so that its rim is out of sight
  view.ground.visible = settings_.ground;
  view.ground.height = hasFloor_ ? floor_ : box.lo.y;
  view.ground.center = box.center();
  view.ground.radius = kGroundShare * length(box.size());
  view.camera = cameraAt(simulation.time());
  return view;
}

void SceneView::collectStatic(Simulation& simulation) {
  collected_ = true;
  checkNames(simulation);
  for (const auto& [node, output] : outputsOf<TriangleMesh>(simulation))
    addSurface(**output, node, motionOf(output));
  for (const auto& node : simulation.scene().graph.nodes()) {
    const auto* boundary = dynamic_cast<const StaticBoundary*>(node.get());
    if (boundary != nullptr && boundary->shape != BoundaryShape::kNone)
      addShape(boundary->boundary->pieces.front().shape, node->name());
    if (const auto* emitter = dynamic_cast<const NozzleEmitter*>(node.get()))
      bounds_.extend(emitter->position);
  }
  boundsAreStatic_ = !bounds_.empty() && length(bounds_.size()) > 0;
}

void SceneView::checkNames(const Simulation& simulation) const {
  for (std::size_t i = 0; i < settings_.surfaces.size(); ++i) {
    const std::string& name = settings_.surfaces[i].node;
    if (simulation.scene().graph.find(name) != nullptr) continue;
    std::vector<std::string> names;
    for (const auto& node : simulation.scene().graph.nodes()) names.push_back(node->name());
    Error e =
        sceneError("the scene has no node " + inQuotes(name), joinNames(names), didYouMean(name, names));
    throw e.at(
        {.file = simulation.scene().file, .pointer = "/render/surfaces/" + std::to_string(i) + "/node"});
  }
}

const SurfaceSettings* SceneView::settingsOf(const std::string& node) const {
  for (std::size_t i = 0; i < settings_.surfaces.size(); ++i)
    if (*settings_.surfaces[i].node == node) return &settings_.surfaces[i];
  return nullptr;
}

void SceneView::addSurface(const TriangleMesh& mesh, const std::string& node, const RigidMotion* motion) {
  const SurfaceSettings* own = settingsOf(node);
  if (mesh.empty() || (own != nullptr && !own->visible)) return;
  const Pose start = motion != nullptr ? motion->poseAt(0) : Pose{};
  for (const Vec3f& vertex : mesh.vertices) bounds_.extend(start.toWorld(vertex));
  static const SurfaceSettings kUsual;
  const SurfaceSettings& look = own != nullptr ? *own : kUsual;
  surfaces_.push_back({.mesh = renderer_.addMesh(mesh), .look = look.look, .color = look.shownColor()});
  motions_.push_back(motion);
}

void SceneView::addShape(const Shape& shape, const std::string& node) {
  const SurfaceSettings* own = settingsOf(node);
  if (own != nullptr && !own->visible) return;
  if (shape.kind == ShapeKind::kPlane) {
    // A floor is the ground; walls without an end would hide the scene.
    constexpr float kLevel = 0.999f;
    hasFloor_ = rotate(shape.rotation, {0, 1, 0}).y > kLevel;
    if (hasFloor_) floor_ = shape.position.y;
    return;
  }
  if (!shape.inverted) {
    addSurface(meshOfShape(shape), node);
    return;
  }
  const std::vector<Line> outline = outlineOfShape(shape);
  for (const Line& line : outline) {
    bounds_.extend(line.from);
    if (settings_.outlines) lines_.insert(lines_.end(), {line.from, line.to});
  }
}

void SceneView::addFluids(Simulation& simulation, View& view) {
  const std::string& by = settings_.color->by;
  const bool colored = by != "none";
  key_.shown = settings_.color->bar && colored;
  key_.quantity = by;
  positions_.clear();
  values_.clear();
  for (const auto& [node, output] : outputsOf<Fluid>(simulation)) {
    const Fluid& fluid = **output;
    const std::int64_t count = fluid.particles->refreshCount();
    positions_.push_back(fluid.particles->positions().toHost(count));
    values_.push_back(colored ? quantityOf(*fluid.particles, by, count, key_) : std::vector<float>{});
    view.particles.push_back({.radius = 0.5f * settings_.particleSize * fluid.constants->spacing,
                              .map = settings_.color->map,
                              .fixed = settings_.color->fixed});
    if (boundsAreStatic_) continue;
    for (const Vec3f& p : positions_.back()) bounds_.extend(p);
  }
  if (colored) chooseRange();
  for (std::size_t i = 0; i < view.particles.size(); ++i) {
    view.particles[i].positions = positions_[i];
    view.particles[i].values = values_[i];
    view.particles[i].lowest = key_.low;
    view.particles[i].highest = key_.high;
  }
}

void SceneView::chooseRange() {
  if (const auto& fixed = settings_.color->range.get()) {
    key_.low = fixed->x, key_.high = fixed->y;
    return;
  }
  // Without a range, the one that holds all that was seen so far, in round numbers so that it seldom changes.
  float low = rangeFound_ ? key_.low : 0, high = rangeFound_ ? key_.high : 0;
  bool any = rangeFound_;
  for (const std::vector<float>& values : values_)
    for (const float v : values) {
      if (!std::isfinite(v)) continue;
      low = any ? std::min(low, v) : v;
      high = any ? std::max(high, v) : v;
      any = true;
    }
  const bool grew = !rangeFound_ || low < key_.low || high > key_.high;
  if (!any || !grew) return;
  rangeFound_ = high > low;
  if (*settings_.color->by == "speed") low = 0;
  const float step = roundUp(std::max(high - low, 1e-6f * std::max(std::abs(high), 1.0f))) / 10;
  key_.low = step * std::floor(low / step);
  key_.high = step * std::ceil(high / step);
  if (!(key_.high > key_.low)) key_.high = key_.low + step;
}

CameraPose SceneView::restingCamera() const {
  const CameraSettings& settings = *settings_.camera;
  const float aspect = float(settings_.width) / float(settings_.height);
  CameraPose camera = poseSeeing(bounds_, {0.55f, 0.42f, 0.72f}, settings.up, settings.fov, aspect);
  if (settings.target.get()) {
    camera.eye = camera.eye + (*settings.target.get() - camera.target);
    camera.target = *settings.target.get();
  }
  if (settings.eye.get()) camera.eye = *settings.eye.get();
  return camera;
}

CameraPose SceneView::cameraAt(double time) const {
  CameraPose camera = restingCamera();
  const auto& keys = settings_.camera->keyframes;
  if (keys.empty()) return camera;
  std::size_t next = 0;
  while (next < keys.size() && keys[next].time <= time) ++next;
  const CameraKey& a = keys[next == 0 ? 0 : next - 1];
  const CameraKey& b = keys[next == keys.size() ? next - 1 : next];
  const double span = b.time - a.time;
  const float t = span > 0 ? static_cast<float>((time - a.time) / span) : 0;
  const float fovA = a.fov.get().value_or(camera.fovDegrees), fovB = b.fov.get().value_or(camera.fovDegrees);
  camera.eye = (1 - t) * a.eye.get() + t * b.eye.get();
  camera.target = (1 - t) * a.target.get() + t * b.target.get();
  camera.fovDegrees = (1 - t) * fovA + t * fovB;
  return camera;
}

}  // namespace weir::rendering
