#include "plugins/rendering/gl/water_shadow.h"

#include <array>

namespace weir::rendering::gl {
WaterShadow::WaterShadow(const Functions& gl)
    : gl_(gl),
      absorb_(gl, "water_shadow.frag"),
      depth_(makeTexture(gl, kResolution, kResolution, kDepth32F, GL_LINEAR)),
      ownDepth_(makeTexture(gl, kResolution, kResolution, kDepth32F, GL_NEAREST)),
      thickness_(makeTexture(gl, kResolution, kResolution, kFloat2, GL_NEAREST)),
      through_(makeTexture(gl, kResolution, kResolution, kColor8, GL_LINEAR)),
      ownDepthTarget_(makeFramebuffer(gl, {}, &ownDepth_)),
      thicknessTarget_(makeFramebuffer(gl, {&thickness_}, nullptr)),
      target_(makeFramebuffer(gl, {&through_}, nullptr)),
      depthTarget_(makeFramebuffer(gl, {}, &depth_)) {
  gl.bindTexture(GL_TEXTURE_2D, depth_.name());
  gl.texParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
  gl.texParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
}

void WaterShadow::draw(const Frame& frame, const MeshStore& meshes, WaterDrawer& particles,
                       const WaterSurfacePass& surfaces) const {
  constexpr std::array<float, 4> kAllLight{1, 1, 1, 1};
  constexpr float kFarthest = 1;
  gl_.viewport(0, 0, kResolution, kResolution);
  gl_.depthMask(GL_TRUE);
  gl_.bindFramebuffer(GL_FRAMEBUFFER, target_.name());
  gl_.clearBufferfv(GL_COLOR, 0, kAllLight.data());
  gl_.bindFramebuffer(GL_FRAMEBUFFER, depthTarget_.name());
  gl_.clearBufferfv(GL_DEPTH, 0, &kFarthest);
  for (std::size_t water = 0; water < frame.view.waters.size(); ++water)
    drawOne(frame, water, meshes, particles, surfaces);
}

void WaterShadow::drawOne(const Frame& frame, std::size_t water, const MeshStore& meshes,
                          WaterDrawer& particles, const WaterSurfacePass& surfaces) const {
  constexpr std::array<float, 4> kNothing{0, 0, 0, 0};
  constexpr float kFarthest = 1;
  gl_.bindFramebuffer(GL_FRAMEBUFFER, ownDepthTarget_.name());
  gl_.clearBufferfv(GL_DEPTH, 0, &kFarthest);
  gl_.enable(GL_DEPTH_TEST);
  gl_.depthFunc(GL_LEQUAL);
  particles.drawSunDepth(frame.sun, water, ownDepth_, kResolution);
  surfaces.drawSunDepth(frame, water, meshes, {kResolution, kResolution});

  gl_.bindFramebuffer(GL_FRAMEBUFFER, thicknessTarget_.name());
  gl_.clearBufferfv(GL_COLOR, 0, kNothing.data());
  gl_.disable(GL_DEPTH_TEST);
  particles.drawSunThickness(frame.sun, water, {thickness_, kResolution, kResolution});
  surfaces.drawSunThickness(frame, water, meshes, {kResolution, kResolution});

  // The tints of several liquids are multiplied, and the nearest depth stays.
  const WaterView& view = frame.view.waters[water];
  gl_.bindFramebuffer(GL_FRAMEBUFFER, target_.name());
  absorb_.use();
  absorb_.setTexture("uThickness", 0, thickness_);
  absorb_.setTexture("uDepth", 1, ownDepth_);
  absorb_.set("uExtinction", view.absorption + Vec3f{1, 1, 1} * (0.5f * view.scattering));
  absorb_.set("uFoamOpacity", view.foamOpacity);
  absorb_.set("uUneven", 0.5f * view.smoothing + 1e-6f);
  gl_.enable(GL_BLEND);
  gl_.blendFunc(GL_DST_COLOR, GL_ZERO);
  absorb_.draw();
  gl_.disable(GL_BLEND);
  gl_.blendFunc(GL_ONE, GL_ZERO);
  gl_.enable(GL_DEPTH_TEST);
  gl_.bindFramebuffer(GL_FRAMEBUFFER, depthTarget_.name());
  absorb_.draw();
}

}  // namespace weir::rendering::gl
