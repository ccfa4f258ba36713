#include "plugins/rendering/gl/water_pass.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "plugins/rendering/gl/sunlight.h"
#include "plugins/rendering/gl/surface_pass.h"

namespace weir::rendering::gl {
namespace {

/// The distance of a liquid's middle from the eye.
float distanceOf(const View& view, const MeshStore& meshes, std::size_t water) {
  Aabb box;
  for (const ParticleView& particles : view.particles)
    if (particles.water == water)
      for (const Vec3f& p : particles.positions)
        if (isFinite(p)) box.extend(p);
  for (const SurfaceView& surface : view.surfaces)
    if (surface.look == SurfaceLook::kWater && surface.water == water)
      box.extend(placedBounds(meshes.bounds(surface.mesh), surface));
  return box.empty() ? 0 : length(box.center() - view.camera.eye);
}

/// m; of the finest particles of a liquid, 0 without any.
float spacingOf(const View& view, std::size_t water) {
  float spacing = std::numeric_limits<float>::infinity();
  for (const ParticleView& particles : view.particles)
    if (particles.water == water && particles.volume > 0)
      spacing = std::min(spacing, std::cbrt(particles.volume));
  return std::isfinite(spacing) ? spacing : 0;
}

std::vector<std::size_t> farthestFirst(const View& view, const MeshStore& meshes) {
  std::vector<std::size_t> order(view.waters.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  if (order.size() < 2) return order;
  std::vector<float> distances;
  for (const std::size_t water : order) distances.push_back(distanceOf(view, meshes, water));
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return distances[a] > distances[b]; });
  return order;
}

bool haveSize(const WaterTargets& water, const Targets& targets) {
  const Texture &pixels = water.scene.texture, &samples = water.depth;
  return pixels.width == targets.pictureWidth && pixels.height == targets.pictureHeight &&
         samples.width == targets.depth.width && samples.height == targets.depth.height;
}

}  // namespace

void WaterPass::draw(const Frame& frame, const Targets& targets, const Parts& parts,
                     const std::function<void(const Texture& depth)>& drawBehind) {
  if (frame.view.waters.empty()) return;
  if (!water_ || !haveSize(*water_, targets)) {
    water_.reset();
    water_.emplace(gl_, targets);
  }
  for (const std::size_t water : farthestFirst(frame.view, parts.meshes))
    drawOne(frame, targets, parts, water, drawBehind);
}

void WaterPass::drawOne(const Frame& frame, const Targets& targets, const Parts& parts, std::size_t water,
                        const std::function<void(const Texture& depth)>& drawBehind) {
  const WaterView& view = frame.view.waters[water];
  drawMaps(frame, targets, parts, water);
  smoothing_.smoothSurface(frame, *water_, view.smoothing);
  smoothing_.smoothThickness(frame, *water_, 0.5f * view.smoothing);
  drawBehind(water_->depth);
  resolveScene(frame, targets);
  shade(frame, targets, parts, water);
  compose(frame, targets);
}

/// Depth, normals and thickness of the liquid.
void WaterPass::drawMaps(const Frame& frame, const Targets& targets, const Parts& parts,
                         std::size_t water) const {
  SeenWater seen{frame, water, parts.meshes, {frame.width, frame.height}};
  water_->surface.clearColor(0, {0, 0, 0, 0});
  water_->surface.clearDepth();
  setState(gl_, {.depthTest = GL_LEQUAL});
  parts.particles.drawDepth(frame, water, water_->depth);
  parts.surfaces.drawDepth(seen);

  drawBackground(frame, targets);
  const Canvas& thickness = water_->thickness[0];
  seen.size = {thickness.texture.width, thickness.texture.height};
  thickness.target.clearColor(0, {0, 0, 0, 0});
  parts.particles.drawThickness(frame, water, water_->depth, water_->background, thickness.texture);
  thickness.target.bind();
  parts.surfaces.drawThickness(seen);
}

void WaterPass::drawBackground(const Frame& frame, const Targets& targets) const {
  const Texture& map = water_->background.texture;
  background_.use();
  setCameraUniforms(background_, frame.camera, frame.width, frame.height);
  background_.setTexture("uDepth", targets.depth);
  background_.set("uSize", Vec2i{map.width, map.height});
  background_.draw(water_->background.target);
}

void WaterPass::resolveScene(const Frame& frame, const Targets& targets) const {
  resolve_.use();
  resolve_.setTexture("uLight", targets.light.texture);
  resolve_.set("uSamples", frame.samples);
  resolve_.draw(water_->scene.target);
}

void WaterPass::shade(const Frame& frame, const Targets& targets, const Parts& parts, std::size_t water) {
  const WaterView& view = frame.view.waters[water];
  const FullScreenProgram& program = shading_.with(sunlightDefines(frame));
  program.use();
  setCameraUniforms(program, frame.camera, targets.pictureWidth, targets.pictureHeight);
  setLightUniforms(program, frame);
  program.setTexture("uNearness", water_->nearness[1].texture);
  program.setTexture("uNormal", water_->normal);
  program.setTexture("uThickness", water_->thickness[0].texture);
  program.setTexture("uScene", water_->scene.texture);
  program.setTexture("uLight", targets.light.texture);
  program.setTexture("uAlbedo", targets.albedo);
  program.setTexture("uDepth", targets.depth);
  setSunlightUniforms(program, frame, parts.shadows, &parts.waterShadows);
  parts.environment.setUniforms(program, frame);
  program.set("uSamples", frame.samples);
  program.set("uUnlit", int(frame.view.lighting.unlit));
  program.set("uAbsorption", view.absorption);
  program.set("uScattered", linear(view.scattered));
  program.set("uScattering", view.scattering);
  program.set("uFoamOpacity", view.foamOpacity);
  program.set("uRefractiveIndex", view.refractiveIndex);
  program.set("uSpacing", spacingOf(frame.view, water));
  program.draw(water_->shaded.target);
}

void WaterPass::compose(const Frame& frame, const Targets& targets) const {
  compose_.use();
  compose_.setTexture("uShaded", water_->shaded.texture);
  compose_.setTexture("uDepth", water_->depth);
  compose_.set("uSamples", frame.samples);
  compose_.draw(targets.lightWithDepth, {.depthTest = GL_LESS});
}

}  // namespace weir::rendering::gl
