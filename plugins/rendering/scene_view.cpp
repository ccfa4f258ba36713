#include "plugins/rendering/scene_view.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "framework/base/text.h"
#include "nodes/particle_fluid/particle_fluid.h"
#include "nodes/square_emitter/square_emitter.h"
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
  view.surfaces = surfaces_;
  view.lines = lines_;
  view.backgroundTop = settings_.backgroundTop;
  view.backgroundBottom = settings_.backgroundBottom;
  addFluids(simulation, view);
  view.bounds = bounds_.empty() ? Aabb{{-1, -1, -1}, {1, 1, 1}} : bounds_;
  view.ground = settings_.ground;
  view.groundHeight = hasFloor_ ? floor_ : view.bounds.lo.y;
  view.camera = cameraAt(simulation.time());
  return view;
}

void SceneView::collectStatic(Simulation& simulation) {
  collected_ = true;
  checkNames(simulation);
  for (const auto& [node, output] : outputsOf<TriangleMesh>(simulation))
    addSurface(std::make_shared<TriangleMesh>(**output), node);
  for (const auto& node : simulation.scene().graph.nodes()) {
    const auto* boundary = dynamic_cast<const StaticBoundary*>(node.get());
    if (boundary != nullptr && boundary->shape != BoundaryShape::kNone)
      addShape(boundary->boundary->pieces.front().shape, node->name());
    if (const auto* emitter = dynamic_cast<const SquareEmitter*>(node.get()))
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

void SceneView::addSurface(std::shared_ptr<const TriangleMesh> mesh, const std::string& node) {
  const SurfaceSettings* own = settingsOf(node);
  if (mesh->empty() || (own != nullptr && !own->visible)) return;
  bounds_.extend(mesh->bounds());
  static const SurfaceSettings kUsual;
  const SurfaceSettings& look = own != nullptr ? *own : kUsual;
  surfaces_.push_back({std::move(mesh), look.look, look.color});
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
    addSurface(std::make_shared<TriangleMesh>(meshOfShape(shape)), node);
    return;
  }
  const std::vector<Line> outline = outlineOfShape(shape);
  for (const Line& line : outline) bounds_.extend(line.from);
  if (settings_.outlines) lines_.insert(lines_.end(), outline.begin(), outline.end());
}

void SceneView::addFluids(Simulation& simulation, View& view) {
  const std::string& by = settings_.color->by;
  key_.shown = settings_.color->bar && by != "none";
  key_.quantity = by;
  std::vector<std::vector<float>> values;
  for (const auto& [node, output] : outputsOf<Fluid>(simulation)) {
    const Fluid& fluid = **output;
    const std::int64_t count = fluid.particles->refreshCount();
    Spheres spheres;
    spheres.radius = 0.5f * settings_.particleSize * fluid.constants->spacing;
    spheres.positions = fluid.particles->positions().toHost(count);
    values.push_back(by == "none" ? std::vector<float>(spheres.positions.size())
                                  : quantityOf(*fluid.particles, by, count, key_));
    if (!boundsAreStatic_)
      for (const Vec3f& p : spheres.positions) bounds_.extend(p);
    view.spheres.push_back(std::move(spheres));
  }
  if (by == "none") {
    const Color& c = settings_.color->fixed;
    for (const float part : {c.r, c.g, c.b})
      view.colors.push_back(static_cast<std::uint8_t>(std::lround(255 * part)));
  } else {
    chooseRange(values);
    const auto table = colorTable(settings_.color->map);
    view.colors.assign(table.begin(), table.end());
  }
  const float scale = 1 / (key_.high - key_.low);
  for (std::size_t k = 0; k < values.size(); ++k) {
    for (float& v : values[k]) v = std::clamp((v - key_.low) * scale, 0.0f, 1.0f);
    view.spheres[k].shade = std::move(values[k]);
  }
}

void SceneView::chooseRange(const std::vector<std::vector<float>>& values) {
  if (const auto& fixed = settings_.color->range.get()) {
    key_.low = fixed->x, key_.high = fixed->y;
    return;
  }
  // Without a range, the one that holds all that was seen so far, in round numbers so that it seldom changes.
  float low = rangeFound_ ? key_.low : 0, high = rangeFound_ ? key_.high : 0;
  bool any = rangeFound_;
  for (const auto& list : values)
    for (const float v : list) {
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

Camera SceneView::fittingCamera() const {
  Camera camera;
  const CameraSettings& settings = *settings_.camera;
  camera.up = settings.up;
  camera.fov = settings.fov;
  const Aabb box = bounds_.empty() ? Aabb{{-1, -1, -1}, {1, 1, 1}} : bounds_;
  camera.target = settings.target.get().value_or(box.center());
  // The sphere around the scene fills the shorter side of the picture.
  const float aspect = std::min(1.0f, float(settings_.width) / float(settings_.height));
  const float half = std::atan(aspect * std::tan(camera.fov * std::numbers::pi_v<float> / 360));
  const float distance = 0.5f * length(box.size()) / std::sin(half);
  const Vec3f direction = normalized(Vec3f{0.55f, 0.42f, 0.72f});
  camera.eye = settings.eye.get().value_or(camera.target + std::max(distance, 1e-3f) * direction);
  return camera;
}

Camera SceneView::cameraAt(double time) const {
  Camera camera = fittingCamera();
  const auto& keys = settings_.camera->keyframes;
  if (keys.empty()) return camera;
  std::size_t next = 0;
  while (next < keys.size() && keys[next].time <= time) ++next;
  const CameraKey& a = keys[next == 0 ? 0 : next - 1];
  const CameraKey& b = keys[next == keys.size() ? next - 1 : next];
  const double span = b.time - a.time;
  const float t = span > 0 ? static_cast<float>((time - a.time) / span) : 0;
  const float fovA = a.fov.get().value_or(camera.fov), fovB = b.fov.get().value_or(camera.fov);
  camera.eye = (1 - t) * a.eye.get() + t * b.eye.get();
  camera.target = (1 - t) * a.target.get() + t * b.target.get();
  camera.fov = (1 - t) * fovA + t * fovB;
  return camera;
}

}  // namespace weir::rendering
