#include "plugins/rendering/gl/water_pass.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "plugins/rendering/gl/sunlight.h"
#include "plugins/rendering/gl/surface_pass.h"

namespace weir::rendering::gl {
namespace {

/// The distance of a liquid's middle from the eye.
float distanceOf(const View& view, const MeshStore& meshes, std::size_t water) {
  Aabb box;
  for (const ParticleView& particles : view.particles)
    if (isWater(particles, water))
      for (const Vec3f& p : particles.positions)
        if (isFinite(p)) box.extend(p);
  for (const SurfaceView& surface : view.surfaces)
    if (surface.look == SurfaceLook::kWater && surface.water == water)
      box.extend(placedBounds(meshes.bounds(surface.mesh), surface));
  return box.empty() ? 0 : length(box.center() - view.camera.eye);
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

}  // namespace

WaterPass::WaterPass(const Functions& gl)
    : gl_(gl),
      smoothing_(gl),
      background_(gl, "water_background.frag"),
      resolve_(gl, "water_scene.frag"),
      compose_(gl, "water_compose.frag") {}

const FullScreenProgram& WaterPass::shadingFor(const Frame& frame) {
  const std::string defines = sunlightDefines(frame);
  const auto known = shading_.find(defines);
  if (known != shading_.end()) return known->second;
  return shading_.emplace(defines, FullScreenProgram(gl_, "water.frag", defines)).first->second;
}

void WaterPass::draw(const Frame& frame, const Targets& targets, const Parts& parts,
                     const std::function<void(const Texture& depth)>& drawBehind) {
  if (frame.view.waters.empty()) return;
  if (!water_ || width_ != targets.pictureWidth || height_ != targets.pictureHeight ||
      samples_ != targets.samples) {
    water_.reset();
    water_.emplace(gl_, targets);
    width_ = targets.pictureWidth, height_ = targets.pictureHeight, samples_ = targets.samples;
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
  shade(frame, targets, parts, view);
  compose(frame, targets);
}

/// Depth, normals and thickness of the liquid.
void WaterPass::drawMaps(const Frame& frame, const Targets& targets, const Parts& parts,
                         std::size_t water) const {
  constexpr std::array<float, 4> kNothing{0, 0, 0, 0};
  constexpr float kFarthest = 1;
  gl_.bindFramebuffer(GL_FRAMEBUFFER, water_->surface.name());
  gl_.viewport(0, 0, frame.width, frame.height);
  gl_.enable(GL_DEPTH_TEST);
  gl_.depthFunc(GL_LEQUAL);
  gl_.depthMask(GL_TRUE);
  gl_.clearBufferfv(GL_COLOR, 0, kNothing.data());
  gl_.clearBufferfv(GL_DEPTH, 0, &kFarthest);
  parts.particles.drawDepth(frame, water, water_->depth);
  parts.surfaces.drawDepth(frame, water, parts.meshes, {frame.width, frame.height});

  gl_.disable(GL_DEPTH_TEST);
  gl_.viewport(0, 0, water_->thicknessWidth, water_->thicknessHeight);
  drawBackground(frame, targets);
  gl_.bindFramebuffer(GL_FRAMEBUFFER, water_->thicknessTargets[0].name());
  gl_.clearBufferfv(GL_COLOR, 0, kNothing.data());
  parts.particles.drawThickness(frame, water, water_->depth, {water_->background, water_->backgroundTarget},
                                {water_->thickness[0], water_->thicknessWidth, water_->thicknessHeight});
  gl_.bindFramebuffer(GL_FRAMEBUFFER, water_->thicknessTargets[0].name());
  parts.surfaces.drawThickness(frame, water, parts.meshes, {water_->thicknessWidth, water_->thicknessHeight});
}

void WaterPass::drawBackground(const Frame& frame, const Targets& targets) const {
  gl_.bindFramebuffer(GL_FRAMEBUFFER, water_->backgroundTarget.name());
  background_.use();
  setCameraUniforms(background_, frame.camera, frame.width, frame.height);
  background_.setTexture("uDepth", 0, targets.depth);
  background_.set("uSize", Vec2i{water_->thicknessWidth, water_->thicknessHeight});
  background_.draw();
}

void WaterPass::resolveScene(const Frame& frame, const Targets& targets) const {
  gl_.disable(GL_DEPTH_TEST);
  gl_.viewport(0, 0, targets.pictureWidth, targets.pictureHeight);
  gl_.bindFramebuffer(GL_FRAMEBUFFER, water_->sceneTarget.name());
  resolve_.use();
  resolve_.setTexture("uLight", 0, targets.light);
  resolve_.set("uSamples", frame.samples);
  resolve_.draw();
}

void WaterPass::shade(const Frame& frame, const Targets& targets, const Parts& parts, const WaterView& view) {
  const FullScreenProgram& program = shadingFor(frame);
  gl_.bindFramebuffer(GL_FRAMEBUFFER, water_->shadedTarget.name());
  program.use();
  setCameraUniforms(program, frame.camera, targets.pictureWidth, targets.pictureHeight);
  setLightUniforms(program, frame);
  program.setTexture("uNearness", 0, water_->nearness[1]);
  program.setTexture("uNormal", 1, water_->normal);
  program.setTexture("uThickness", 2, water_->thickness[0]);
  program.setTexture("uScene", 3, water_->scene);
  program.setTexture("uDepth", 4, targets.depth);
  setSunlightUniforms(program, frame, parts.shadows, &parts.waterShadows, 5);
  parts.environment.setUniforms(program, frame, 9);
  program.set("uSamples", frame.samples);
  program.set("uUnlit", int(frame.view.lighting.unlit));
  program.set("uAbsorption", view.absorption);
  program.set("uScattered", linear(view.scattered));
  program.set("uScattering", view.scattering);
  program.set("uFoamOpacity", view.foamOpacity);
  program.set("uRefractiveIndex", view.refractiveIndex);
  program.draw();
}

void WaterPass::compose(const Frame& frame, const Targets& targets) const {
  gl_.bindFramebuffer(GL_FRAMEBUFFER, targets.lightWithDepth.name());
  gl_.viewport(0, 0, frame.width, frame.height);
  gl_.enable(GL_DEPTH_TEST);
  gl_.depthFunc(GL_LESS);
  compose_.use();
  compose_.setTexture("uShaded", 0, water_->shaded);
  compose_.setTexture("uDepth", 1, water_->depth);
  compose_.set("uSamples", frame.samples);
  compose_.draw();
  gl_.depthFunc(GL_LEQUAL);
}

}  // namespace weir::rendering::gl
