#include "plugins/rendering/scene_view.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

namespace weir::rendering {

namespace {

std::vector<float> lengthsOf(std::span<const Vec3f> vectors) {
  std::vector<float> lengths;
  lengths.reserve(vectors.size());
  for (const Vec3f& v : vectors) lengths.push_back(length(v));
  return lengths;
}

/// The numbers that colour the particles; none if they have one colour.
std::vector<float> colorsOf(FluidSnapshot& fluid) {
  if (!fluid.colorType) return {};
  switch (*fluid.colorType) {
    case AttributeType::kFloat: {
      const std::span<const float> numbers = fluid.floats.wait();
      return {numbers.begin(), numbers.end()};
    }
    case AttributeType::kVec3:
      return lengthsOf(fluid.vectors.wait());
    case AttributeType::kInt:
      break;
  }
  const std::span<const int> numbers = fluid.ints.wait();
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

View SceneView::of(SceneSnapshot& snapshot) {
  if (snapshot.still) takeStill(*std::exchange(snapshot.still, nullptr));
  View view;
  view.width = settings_.width;
  view.height = settings_.height;
  view.backgroundTop = settings_.backgroundTop;
  view.backgroundBottom = settings_.backgroundBottom;
  view.waters = surfaceWaters_;
  addFluids(snapshot, view);
  view.surfaces = surfaces_;
  for (std::size_t i = 0; i < surfaces_.size(); ++i) {
    view.surfaces[i].rotation = snapshot.poses[i].rotation;
    view.surfaces[i].position = snapshot.poses[i].translation;
  }
  if (!lines_.empty()) view.lines.push_back({.points = lines_});
  const Aabb box = bounds_.empty() ? Aabb{{-1, -1, -1}, {1, 1, 1}} : bounds_;
  constexpr float kGroundShare = 4;  // of the size of the scene, so that its rim is out of sight
  view.ground.visible = settings_.ground;
  view.ground.height = floor_.value_or(box.lo.y);
  view.ground.center = box.center();
  view.ground.radius = kGroundShare * length(box.size());
  const EnvironmentSettings& environment = *settings_.environment;
  view.ground.color = environment.groundColor;
  view.ground.tiles = environment.groundTiles;
  view.lighting.towardsSun = environment.sun;
  view.lighting.exposure = environment.exposure;
  view.lighting.tone = environment.tone;
  view.environment = environment.look;
  view.camera = cameraAt(snapshot.time);
  return view;
}

void SceneView::takeStill(StillScene& still) {
  for (const StillScene::Surface& surface : still.surfaces) {
    surfaces_.push_back({.mesh = renderer_.addMesh(surface.mesh),
                         .look = surface.look,
                         .color = surface.color,
                         .water = surfaceWaters_.size()});
    if (surface.water) surfaceWaters_.push_back(*surface.water);
  }
  lines_ = std::move(still.lines);
  bounds_ = still.bounds;
  floor_ = still.floor;
  boundsAreStatic_ = !bounds_.empty() && length(bounds_.size()) > 0;
}

void SceneView::addFluids(SceneSnapshot& snapshot, View& view) {
  const std::string& by = settings_.color->by;
  const bool colored = by != "none";
  key_.shown = false;
  key_.quantity = by;
  key_.unit = snapshot.colorUnit;
  values_.clear();
  foam_.clear();
  foam_.reserve(snapshot.fluids.size());  // views point to its elements
  for (FluidSnapshot& fluid : snapshot.fluids) {
    const std::span<const Vec3f> positions = fluid.positions.wait();
    const bool water = fluid.look != nullptr && fluid.look->look == FluidLook::kWater;
    if (!water) key_.shown = settings_.color->bar && colored;
    values_.push_back(water ? std::vector<float>() : colorsOf(fluid));
    view.particles.push_back({.positions = positions,
                              .radius = 0.5f * settings_.particleSize * fluid.spacing,
                              .map = settings_.color->map,
                              .fixed = settings_.color->fixed});
    if (water) addWater(fluid, view);
    if (boundsAreStatic_) continue;
    for (const Vec3f& p : positions) bounds_.extend(p);
  }
  if (colored) chooseRange();
  for (std::size_t i = 0; i < view.particles.size(); ++i) {
    view.particles[i].values = values_[i];
    view.particles[i].lowest = key_.low;
    view.particles[i].highest = key_.high;
  }
}

/// Makes a liquid of the particles that were added last.
void SceneView::addWater(FluidSnapshot& fluid, View& view) {
  const FluidSettings& look = *fluid.look;
  ParticleView& particles = view.particles.back();
  // Larger than the spheres, so that the gaps between neighbours close.
  constexpr float kLarger = 1.5f;
  particles.radius *= kLarger;
  particles.volume = fluid.spacing * fluid.spacing * fluid.spacing;
  particles.water = view.waters.size();
  foam_.push_back(colorsOf(fluid));
  for (float& value : foam_.back()) value = look.foam->whitenessOf(value);
  particles.foam = foam_.back();
  view.waters.push_back(waterView(*look.water, look.smoothing * fluid.spacing, look.foam->opacity));
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
