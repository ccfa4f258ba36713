#include "plugins/views/scene_view.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "framework/base/check.h"
#include "plugins/views/camera_path.h"
#include "plugins/views/environment_file.h"
#include "plugins/views/frame_kernels.h"
#include "plugins/views/surface_foam.h"
#include "plugins/views/surface_means.h"
#include "plugins/views/velocity_arrows.h"

namespace weir::rendering {

namespace {

/// The next of 1, 2, 5, 10, … times a power of ten that is not below x > 0.
float roundUp(float x) {
  const float power = std::pow(10.0f, std::floor(std::log10(x)));
  for (const float step : {1.0f, 2.0f, 5.0f})
    if (step * power >= x) return step * power;
  return 10 * power;
}

/// The box around the boxes of all ranks, if there are some, and likewise their range.
Aabb boxOfRanks(Communicator* ranks, const Aabb& own) {
  if (ranks == nullptr) return own;
  Aabb all;
  for (const Aabb& of : ranks->allGather(own)) all.extend(of);
  return all;
}

Vec2f rangeOfRanks(Communicator* ranks, Vec2f range) {
  if (ranks == nullptr) return range;
  for (const Vec2f& of : ranks->allGather(range)) range = {std::min(range.x, of.x), std::max(range.y, of.y)};
  return range;
}

Device& deviceOf(const PictureMaker& maker) {
  WEIR_CHECK(maker.device() != nullptr);
  return *maker.device();
}

}  // namespace

SceneView::SceneView(const RenderSettings& settings, const CameraSettings& camera, PictureMaker& maker,
                     Communicator* ranks)
    : settings_(settings),
      camera_(camera),
      maker_(maker),
      ranks_(ranks),
      device_(deviceOf(maker)),
      map_(settings.color->colorMap()),
      cuts_(cutsOf(settings.clips)) {
  const EnvironmentSettings& environment = *settings.environment;
  if (environment.look == EnvironmentLook::kImage)
    image_ = readEnvironment(environment.image->resolved, environment.turn, environment.brightness);
}

View SceneView::of(SceneSnapshot& snapshot, ParticlePlace place) {
  if (snapshot.still) takeStill(*snapshot.still);
  View view;
  view.frame = snapshot.frame;
  view.time = snapshot.time;
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
    const Pose& before = snapshot.posesBefore[i];
    view.surfaces[i].before = Placement{before.rotation, before.translation};
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
  addEnvironment(settings_, view);
  view.environmentImage = image_;
  if (image_ && !settings_.environment->sun.isSet()) view.lighting.towardsSun = image_->towardsSun;
  // Ranges, bounds and what cameras follow are those of all particles.
  const std::size_t fluids = view.particles.size();
  for (std::size_t i = 0; i < fluids && !cuts_.empty(); ++i) shown_[i]->cut(cuts_);
  addSpray(snapshot, view);
  const bool onDevice = place != ParticlePlace::kHost && maker_.readsDevice(view);
  for (std::size_t i = 0; i < view.particles.size(); ++i)
    (i < fluids ? shown_[i] : spray_[i - fluids])->give(view.particles[i], onDevice);
  addFoam(snapshot, view);
  return view;
}

void SceneView::addEnvironment(const RenderSettings& settings, View& view) {
  const EnvironmentSettings& environment = *settings.environment;
  view.ground.color = environment.groundColor;
  view.ground.tiles = environment.groundTiles;
  view.lighting.towardsSun = environment.sun;
  view.lighting.exposure = environment.exposure;
  view.lighting.tone = environment.tone;
  view.lighting.sunStrength = environment.sunStrength;
  view.environment = environment.look;
  view.environmentBehind = environment.background;
  view.transparent = settings.transparent;
}

std::size_t SceneView::indexOfWater(const WaterView& water) {
  const auto same = std::ranges::find(surfaceWaters_, water);
  const auto index = static_cast<std::size_t>(same - surfaceWaters_.begin());
  if (same == surfaceWaters_.end()) surfaceWaters_.push_back(water);
  return index;
}

void SceneView::takeStill(const StillScene& still) {
  for (const StillScene::Surface& surface : still.surfaces)
    surfaces_.push_back({.mesh = maker_.addMesh(surface.mesh),
                         .look = surface.look,
                         .color = surface.color,
                         .water = surface.water ? indexOfWater(*surface.water) : 0,
                         .node = surface.node});
  for (std::size_t i = 0; i < still.surfaces.size(); ++i) {
    const bool isFollowed =
        still.surfaces[i].node == *camera_.follow || still.surfaces[i].from == *camera_.follow;
    if (!isFollowed || followedSurface_) continue;
    followedSurface_ = i;
    Aabb box;
    for (const Vec3f& vertex : still.surfaces[i].mesh.vertices) box.extend(vertex);
    followedMiddle_ = box.center();
  }
  lines_ = still.lines;
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
  while (shown_.size() < snapshot.fluids.size()) shown_.push_back(std::make_unique<ShownParticles>(device_));
  for (std::size_t i = 0; i < snapshot.fluids.size(); ++i) {
    FluidSnapshot& fluid = snapshot.fluids[i];
    const bool water = fluid.look != nullptr && fluid.look->look == FluidLook::kWater;
    if (!water && !fluid.white) key_.shown = settings_.color->bar && colored;
    shown_[i]->load(fluid, water ? fluid.look->foam->range.get() : std::optional<Vec2f>());
    const float radius = 0.5f * settings_.particleSize * fluid.spacing;
    view.particles.push_back({.radius = fluid.white ? shownShareOf(WhiteKind::kFoam) * radius : radius,
                              .map = map_,
                              .fixed = fluid.white ? kWhite : settings_.color->fixed.get(),
                              .node = fluid.node,
                              .white = fluid.white});
    if (water) addWater(fluid, view);
    if (!boundsAreStatic_) bounds_.extend(boxOfRanks(ranks_, shown_[i]->box()));
  }
  loadSurfaceFluids(snapshot);
  if (colored) chooseRange(view);
  for (std::size_t i = 0; i < view.particles.size(); ++i) {
    view.particles[i].lowest = key_.low;
    view.particles[i].highest = key_.high;
  }
}

/// Makes a liquid of the particles that were added last.
void SceneView::addWater(const FluidSnapshot& fluid, View& view) {
  const FluidSettings& look = *fluid.look;
  ParticleView& particles = view.particles.back();
  // Larger than the spheres, so that the gaps between neighbours close.
  constexpr float kLarger = 1.5f;
  particles.radius *= kLarger;
  particles.volume = fluid.spacing * fluid.spacing * fluid.spacing;
  particles.water = view.waters.size();
  view.waters.push_back(waterView(*look.water, look.smoothing * fluid.spacing, look.foam->opacity));
}

void SceneView::addSpray(const SceneSnapshot& snapshot, View& view) {
  constexpr float kShare = 0.25f;  // of the spacing: their radius
  std::size_t count = 0;
  for (std::size_t i = 0; i < snapshot.fluids.size(); ++i) {
    const FluidSnapshot& fluid = snapshot.fluids[i];
    if (!view.particles[i].water || !breaksUp(fluid.spacing)) continue;
    if (count == spray_.size()) spray_.push_back(std::make_unique<ShownParticles>(device_));
    shown_[i]->giveLone(fluid.spacing, *spray_[count++]);
    view.particles.push_back({.radius = kShare * settings_.particleSize * fluid.spacing,
                              .map = map_,
                              .fixed = kWhite,
                              .node = fluid.node + " spray",
                              .white = true});
  }
}

void SceneView::addArrows(SceneSnapshot& snapshot, View& view) {
  const ArrowSettings& settings = *settings_.arrows;
  arrows_.clear();
  for (FluidSnapshot& fluid : snapshot.fluids)
    addVelocityArrows(placesOnHost_.of(fluid.positions.on(device_, placeRoom_)),
                      velocitiesOnHost_.of(fluid.velocities.on(device_, velocityRoom_)), cuts_,
                      *settings.spacing.get(), settings.seconds, view.camera.eye, arrows_);
  // With light rims, so that they can be seen on dark fluids.
  constexpr Color kRim{1, 1, 1, 0.75f};
  view.lines.push_back({.points = arrows_, .color = kRim, .width = 2.4f * settings.width});
  view.lines.push_back({.points = arrows_, .color = settings.color, .width = settings.width});
}

void SceneView::loadSurfaceFluids(SceneSnapshot& snapshot) {
  for (std::size_t i = 0; i < snapshot.fluidSurfaces.size(); ++i) {
    if (i == surfaceFluids_.size()) surfaceFluids_.push_back(std::make_unique<ShownParticles>(device_));
    FluidSnapshot& fluid = snapshot.fluidSurfaces[i].fluid;
    if (fluid.positions.size() > 0) surfaceFluids_[i]->load(fluid, std::nullopt);
    if (fluid.colorType) key_.shown = settings_.color->bar;
  }
}

void SceneView::addFluidSurfaces(SceneSnapshot& snapshot, View& view) {
  fieldsOfSurfaces_.assign(snapshot.fluidSurfaces.size(), {});
  for (std::size_t i = 0; i < snapshot.fluidSurfaces.size(); ++i) {
    FluidSurfaceSnapshot& surface = snapshot.fluidSurfaces[i];
    const MeshSpan mesh = surface.mesh.wait();
    SurfaceFields& fields = fieldsOfSurfaces_[i];
    findFields(surface.fluid, mesh, *surfaceFluids_[i], fields);
    if (i == fluidSurfaces_.size()) fluidSurfaces_.push_back(maker_.addMesh({}));
    maker_.replaceMesh(fluidSurfaces_[i], {mesh, fields.colors});
    if (mesh.triangles.empty()) continue;
    view.surfaces.push_back({.mesh = fluidSurfaces_[i],
                             .look = surface.look,
                             .color = fields.colors.empty() ? surface.color : Color{1, 1, 1, 1},
                             .water = view.waters.size(),
                             .node = surface.node,
                             .velocities = fields.velocities,
                             .foamReach = surface.foamReach});
    if (surface.water) view.waters.push_back(*surface.water);
    if (boundsAreStatic_) continue;
    for (const Vec3f& p : mesh.vertices) bounds_.extend(p);
  }
}

constexpr float kMixed = 1.5f;  // spacings over which colours of surfaces are mixed

void SceneView::findFields(const FluidSnapshot& fluid, const MeshSpan& mesh, ShownParticles& shown,
                           SurfaceFields& fields) const {
  ParticleView particles;
  shown.give(particles, false);
  if (particles.velocities.empty() && particles.values.empty()) return;
  const NearParticles near(particles.positions, 2 * fluid.spacing);
  if (!particles.velocities.empty()) fields.velocities = meansAt(mesh.vertices, near, particles.velocities);
  if (particles.values.empty()) return;
  std::vector<Vec3f> colors;
  colors.reserve(particles.values.size());
  for (const float value : particles.values)
    colors.push_back(map_.at((value - key_.low) / (key_.high - key_.low)));
  // The nearest particles outweigh all others, so that where colours meet, each particle would be seen as a
  // grain.
  fields.colors = mixedAlong(mesh, meansAt(mesh.vertices, near, colors), kMixed * fluid.spacing);
}

void SceneView::addFoam(SceneSnapshot& snapshot, View& view) {
  foamRadii_.resize(view.particles.size());
  for (SurfaceView& surface : view.surfaces) {
    if (!(surface.foamReach > 0)) continue;
    const auto i = std::size_t(std::find(fluidSurfaces_.begin(), fluidSurfaces_.end(), surface.mesh) -
                               fluidSurfaces_.begin());
    SurfaceFoam foam(snapshot.fluidSurfaces[i].mesh.wait().vertices, surface.foamReach);
    for (std::size_t k = 0; k < snapshot.fluids.size(); ++k) {
      ParticleView& particles = view.particles[k];
      const std::span<const int> kinds = shown_[k]->kinds();
      if (kinds.empty()) continue;
      foamRadii_[k] = foam.lay(particles.positions, particles.radii, kinds);
      particles.radii = foamRadii_[k];
    }
    fieldsOfSurfaces_[i].foam = std::move(foam.cover);
    surface.foam = fieldsOfSurfaces_[i].foam;
  }
}

void SceneView::chooseRange(const View& view) {
  if (const auto& fixed = settings_.color->range.get()) {
    key_.low = fixed->x, key_.high = fixed->y;
    return;
  }
  // Without a range, the one that holds all that was seen so far, in round numbers so that it seldom changes.
  constexpr float kNone = std::numeric_limits<float>::infinity();
  float low = rangeFound_ ? key_.low : kNone, high = rangeFound_ ? key_.high : -kNone;
  const auto widen = [&](ShownParticles& particles) {
    const Vec2f range = rangeOfRanks(ranks_, particles.range());
    low = std::min(low, range.x);
    high = std::max(high, range.y);
  };
  for (std::size_t i = 0; i < view.particles.size(); ++i)
    if (!view.particles[i].water && !view.particles[i].white) widen(*shown_[i]);
  for (const auto& fluid : surfaceFluids_) widen(*fluid);
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

std::optional<Vec3f> SceneView::followedPlace(const SceneSnapshot& snapshot) {
  const std::string& name = camera_.follow;
  if (name.empty()) return std::nullopt;
  if (followedSurface_) return snapshot.poses[*followedSurface_].toWorld(followedMiddle_);
  for (std::size_t i = 0; i < snapshot.fluids.size(); ++i)
    if (snapshot.fluids[i].node == name) return shown_[i]->middle();
  return std::nullopt;
}

}  // namespace weir::rendering
