#include "plugins/rendering/scene_view.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "plugins/rendering/camera_path.h"
#include "plugins/rendering/environment_file.h"
#include "plugins/rendering/velocity_arrows.h"

namespace weir::rendering {

namespace {

/// The numbers that colour the particles; none if they have one colour. The vector keeps its memory from
/// frame to frame.
void setColors(FluidSnapshot& fluid, std::vector<float>& to) {
  to.clear();
  if (!fluid.colorType) return;
  switch (*fluid.colorType) {
    case AttributeType::kFloat: {
      const std::span<const float> numbers = fluid.floats.wait();
      to.assign(numbers.begin(), numbers.end());
      break;
    }
    case AttributeType::kVec3: {
      const std::span<const Vec3f> vectors = fluid.vectors.wait();
      to.resize(vectors.size());
      std::transform(vectors.begin(), vectors.end(), to.begin(), [](const Vec3f& v) { return length(v); });
      break;
    }
    case AttributeType::kInt: {
      const std::span<const int> numbers = fluid.ints.wait();
      to.assign(numbers.begin(), numbers.end());
      break;
    }
  }
}

/// The next of 1, 2, 5, 10, … times a power of ten that is not below x > 0.
float roundUp(float x) {
  const float power = std::pow(10.0f, std::floor(std::log10(x)));
  for (const float step : {1.0f, 2.0f, 5.0f})
    if (step * power >= x) return step * power;
  return 10 * power;
}

}  // namespace

SceneView::SceneView(const RenderSettings& settings, const CameraSettings& camera, gl::Renderer& renderer)
    : settings_(settings), camera_(camera), renderer_(renderer), map_(settings.color->colorMap()) {
  const EnvironmentSettings& environment = *settings.environment;
  if (environment.look == EnvironmentLook::kImage)
    image_ = readEnvironment(environment.image->resolved, environment.turn, environment.brightness);
}

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
  addFluidSurfaces(snapshot, view);
  view.camera = cameraAt(camera_, restingCamera(), snapshot.time, followedPlace(snapshot));
  if (!lines_.empty()) view.lines.push_back({.points = lines_});
  if (settings_.arrows->spacing.get()) addArrows(snapshot, view);
  const Aabb box = bounds_.empty() ? Aabb{{-1, -1, -1}, {1, 1, 1}} : bounds_;
  constexpr float kGroundShare = 4;  // of the size of the scene, so that its rim is out of sight
  view.ground.visible = settings_.ground;
  view.ground.height = floor_.value_or(box.lo.y);
  view.ground.center = box.center();
  view.ground.radius = kGroundShare * length(box.size());
  addEnvironment(view);
  view.transparent = settings_.transparent;
  return view;
}

void SceneView::addEnvironment(View& view) const {
  const EnvironmentSettings& environment = *settings_.environment;
  view.ground.color = environment.groundColor;
  view.ground.tiles = environment.groundTiles;
  view.lighting.towardsSun = environment.sun;
  view.lighting.exposure = environment.exposure;
  view.lighting.tone = environment.tone;
  view.lighting.sunStrength = environment.sunStrength;
  view.environment = environment.look;
  view.environmentImage = image_;
  view.environmentBehind = environment.background;
  if (image_ && !environment.sun.isSet()) view.lighting.towardsSun = image_->towardsSun;
}

void SceneView::takeStill(StillScene& still) {
  for (const StillScene::Surface& surface : still.surfaces) {
    surfaces_.push_back({.mesh = renderer_.addMesh(surface.mesh),
                         .look = surface.look,
                         .color = surface.color,
                         .water = surfaceWaters_.size()});
    if (surface.water) surfaceWaters_.push_back(*surface.water);
  }
  for (std::size_t i = 0; i < still.surfaces.size(); ++i) {
    if (still.surfaces[i].node != *camera_.follow || followedSurface_) continue;
    followedSurface_ = i;
    Aabb box;
    for (const Vec3f& vertex : still.surfaces[i].mesh.vertices) box.extend(vertex);
    followedMiddle_ = box.center();
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
  values_.resize(snapshot.fluids.size());
  foam_.resize(snapshot.fluids.size());
  for (std::size_t i = 0; i < snapshot.fluids.size(); ++i) {
    FluidSnapshot& fluid = snapshot.fluids[i];
    const std::span<const Vec3f> positions = fluid.positions.wait();
    const bool water = fluid.look != nullptr && fluid.look->look == FluidLook::kWater;
    if (!water) key_.shown = settings_.color->bar && colored;
    setColors(fluid, water ? foam_[i] : values_[i]);
    view.particles.push_back({.positions = positions,
                              .radius = 0.5f * settings_.particleSize * fluid.spacing,
                              .map = map_,
                              .fixed = settings_.color->fixed});
    if (water) addWater(fluid, view);
    if (boundsAreStatic_) continue;
    for (const Vec3f& p : positions) bounds_.extend(p);
  }
  if (colored) chooseRange();
  shown_.resize(view.particles.size());
  for (std::size_t i = 0; i < view.particles.size(); ++i) {
    view.particles[i].values = values_[i];
    if (!settings_.clips.empty()) shown_[i].choose(settings_.clips, view.particles[i]);
    view.particles[i].lowest = key_.low;
    view.particles[i].highest = key_.high;
  }
}

/// Makes a liquid of the particles that were added last.
void SceneView::addWater(FluidSnapshot& fluid, View& view) {
  const FluidSettings& look = *fluid.look;
  std::vector<float>& foam = foam_[view.particles.size() - 1];
  ParticleView& particles = view.particles.back();
  // Larger than the spheres, so that the gaps between neighbours close.
  constexpr float kLarger = 1.5f;
  particles.radius *= kLarger;
  particles.volume = fluid.spacing * fluid.spacing * fluid.spacing;
  particles.water = view.waters.size();
  for (float& value : foam) value = look.foam->whitenessOf(value);
  particles.foam = foam;
  view.waters.push_back(waterView(*look.water, look.smoothing * fluid.spacing, look.foam->opacity));
}

void SceneView::addArrows(SceneSnapshot& snapshot, View& view) {
  const ArrowSettings& settings = *settings_.arrows;
  arrows_.clear();
  for (FluidSnapshot& fluid : snapshot.fluids)
    addVelocityArrows(fluid.positions.wait(), fluid.velocities.wait(), settings_.clips,
                      *settings.spacing.get(), settings.seconds, view.camera.eye, arrows_);
  // With light rims, so that they can be seen on dark fluids.
  constexpr Color kRim{1, 1, 1, 0.75f};
  view.lines.push_back({.points = arrows_, .color = kRim, .width = 2.4f * settings.width});
  view.lines.push_back({.points = arrows_, .color = settings.color, .width = settings.width});
}

void SceneView::addFluidSurfaces(SceneSnapshot& snapshot, View& view) {
  for (std::size_t i = 0; i < snapshot.fluidSurfaces.size(); ++i) {
    FluidSurfaceSnapshot& surface = snapshot.fluidSurfaces[i];
    const MeshSpan mesh = surface.mesh.wait();
    if (i == fluidSurfaces_.size()) fluidSurfaces_.push_back(renderer_.addMesh({}));
    renderer_.replaceMesh(fluidSurfaces_[i], mesh);
    if (mesh.triangles.empty()) continue;
    view.surfaces.push_back({.mesh = fluidSurfaces_[i],
                             .look = surface.look,
                             .color = surface.color,
                             .water = view.waters.size()});
    if (surface.water) view.waters.push_back(*surface.water);
    if (boundsAreStatic_) continue;
    for (const Vec3f& p : mesh.vertices) bounds_.extend(p);
  }
}

void SceneView::chooseRange() {
  if (const auto& fixed = settings_.color->range.get()) {
    key_.low = fixed->x, key_.high = fixed->y;
    return;
  }
  // Without a range, the one that holds all that was seen so far, in round numbers so that it seldom changes.
  constexpr float kNone = std::numeric_limits<float>::infinity();
  float low = rangeFound_ ? key_.low : kNone, high = rangeFound_ ? key_.high : -kNone;
  for (const std::vector<float>& values : values_)
    for (const float v : values) {
      if (!std::isfinite(v)) continue;
      low = v < low ? v : low;
      high = v > high ? v : high;
    }
  const bool grew = !rangeFound_ || low < key_.low || high > key_.high;
  if (!(low <= high) || !grew) return;
  rangeFound_ = high > low;
  if (*settings_.color->by == "speed") low = 0;
  const float step = roundUp(std::max(high - low, 1e-6f * std::max(std::abs(high), 1.0f))) / 10;
  key_.low = step * std::floor(low / step);
  key_.high = step * std::ceil(high / step);
  if (!(key_.high > key_.low)) key_.high = key_.low + step;
}

CameraPose SceneView::restingCamera() const {
  const CameraSettings& settings = camera_;
  const float aspect = float(settings_.width) / float(settings_.height);
  CameraPose camera = poseSeeing(bounds_, {0.55f, 0.42f, 0.72f}, settings.up, settings.fov, aspect);
  if (settings.target.get()) {
    camera.eye = camera.eye + (*settings.target.get() - camera.target);
    camera.target = *settings.target.get();
  }
  if (settings.eye.get()) camera.eye = *settings.eye.get();
  return camera;
}

std::optional<Vec3f> SceneView::followedPlace(SceneSnapshot& snapshot) const {
  const std::string& name = camera_.follow;
  if (name.empty()) return std::nullopt;
  if (followedSurface_) return snapshot.poses[*followedSurface_].toWorld(followedMiddle_);
  Vec3d sum;
  std::int64_t count = 0;
  for (FluidSnapshot& fluid : snapshot.fluids) {
    if (fluid.node != name) continue;
    for (const Vec3f& p : fluid.positions.wait()) {
      if (!isFinite(p)) continue;
      sum += Vec3d{p.x, p.y, p.z};
      ++count;
    }
  }
  if (count == 0) return std::nullopt;
  const Vec3d middle = sum / static_cast<double>(count);
  return Vec3f{static_cast<float>(middle.x), static_cast<float>(middle.y), static_cast<float>(middle.z)};
}

}  // namespace weir::rendering
