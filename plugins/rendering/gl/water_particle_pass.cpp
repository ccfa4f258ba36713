#include "plugins/rendering/gl/water_particle_pass.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "framework/base/check.h"
#include "plugins/rendering/gl/particle_pass.h"

namespace weir::rendering::gl {
float insetOf(const ParticleView& particles) {
  return std::max(0.0f, particles.radius - 0.5f * std::cbrt(particles.volume));
}

float chordOf(const ParticleView& particles) {
  const float r = particles.radius;
  const float sphere = 4 * std::numbers::pi_v<float> / 3 * r * r * r;
  return 2 * r * (particles.volume > 0 ? particles.volume / sphere : 1.0f);
}

WaterParticlePass::WaterParticlePass(const Functions& gl)
    : gl_(gl),
      depth_(gl, "sphere.vert", "water_depth.frag"),
      sunDepth_(gl, "sun_sphere.vert", "sun_sphere.frag"),
      thickness_(gl, "water_thickness.vert", "water_thickness.frag"),
      batches_(gl),
      nothing_(makeTexture(gl, 1, 1, kFloat1, GL_NEAREST)) {}

Aabb WaterParticlePass::load(std::span<const ParticleView> views) {
  batches_.clear();
  liquids_.clear();
  Aabb box;
  for (const ParticleView& view : views) {
    if (!view.water) continue;
    const bool foams = !view.foam.empty();
    if (foams) WEIR_CHECK(view.foam.size() == view.positions.size());
    box.extend(
        batches_.add(view, liquids_.size(), [&](std::size_t i) { return foams ? view.foam[i] : 0.0f; }));
    liquids_.push_back({*view.water, chordOf(view), insetOf(view)});
  }
  return box;
}

template <class SetUniforms>
void WaterParticlePass::draw(const Program& program, std::size_t water,
                             const SetUniforms& setUniforms) const {
  batches_.draw(program, [&](const SphereBatches::Batch& batch) {
    const Liquid& liquid = liquids_[batch.owner];
    if (liquid.water != water) return false;
    program.set("uRadius", batch.radius);
    setUniforms(batch, liquid);
    return true;
  });
}

template <class SetUniforms>
void WaterParticlePass::addThickness(std::size_t water, const ThicknessMap& map,
                                     const SetUniforms& setUniforms) const {
  gl_.enable(GL_BLEND);
  gl_.blendFunc(GL_ONE, GL_ONE);
  draw(thickness_, water, [&](const SphereBatches::Batch& batch, const Liquid& liquid) {
    thickness_.set("uSize", Vec2f{float(map.width), float(map.height)});
    thickness_.set("uChord", liquid.chord);
    setUniforms(batch);
  });
  gl_.disable(GL_BLEND);
  gl_.blendFunc(GL_ONE, GL_ZERO);
}

void WaterParticlePass::drawDepth(const Frame& frame, std::size_t water, const Texture&) {
  draw(depth_, water, [&](const SphereBatches::Batch&, const Liquid& liquid) {
    depth_.set("uInset", liquid.inset);
    setCameraUniforms(depth_, frame.camera, frame.width, frame.height);
    depth_.setMatrix4("uView", frame.camera.view.data());
    depth_.set("uNear", frame.camera.near);
  });
}

void WaterParticlePass::drawThickness(const Frame& frame, std::size_t water, const Texture& front,
                                      const LiquidBackground& background, const ThicknessMap& map) {
  const Eigen::Matrix4f toClip = frame.camera.projection() * frame.camera.view;
  addThickness(water, map, [&](const SphereBatches::Batch& batch) {
    setCameraUniforms(thickness_, frame.camera, map.width, map.height);
    thickness_.setMatrix4("uToClip", toClip.data());
    thickness_.set("uTexels", 0.5f * float(map.height) / frame.camera.tangent.y);
    thickness_.set("uNear", frame.camera.near);
    thickness_.set("uFoamDepth", kFoamDepth * batch.radius);
    thickness_.setTexture("uFront", 1, front);
    thickness_.setTexture("uBackground", 2, background.distance);
  });
}

void WaterParticlePass::drawSunDepth(const SunView& sun, std::size_t water, const Texture&, int) {
  draw(sunDepth_, water, [&](const SphereBatches::Batch& batch, const Liquid&) {
    setSunSphereUniforms(sunDepth_, sun, batch.radius);
  });
}

void WaterParticlePass::drawSunThickness(const SunView& sun, std::size_t water, const ThicknessMap& map) {
  addThickness(water, map, [&](const SphereBatches::Batch&) {
    thickness_.setMatrix4("uToClip", sun.toClip().eval().data());
    thickness_.set("uTexels", 0.5f * float(map.height) / sun.halfSize);
    thickness_.set("uNear", 0.0f);
    thickness_.set("uFoamDepth", 0.0f);
    thickness_.setTexture("uFront", 1, nothing_);
    thickness_.setTexture("uBackground", 2, nothing_);
  });
}

}  // namespace weir::rendering::gl
