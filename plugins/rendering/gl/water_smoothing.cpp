#include "plugins/rendering/gl/water_smoothing.h"

namespace weir::rendering::gl {
WaterTargets::WaterTargets(const Functions& gl, const Targets& targets)
    : thicknessWidth((targets.pictureWidth + 1) / 2), thicknessHeight((targets.pictureHeight + 1) / 2) {
  const int width = targets.pictureWidth, height = targets.pictureHeight;
  depth = makeTexture(gl, width * targets.samples, height * targets.samples, kDepth32F, GL_NEAREST);
  normal = makeTexture(gl, width * targets.samples, height * targets.samples, kColor16, GL_NEAREST);
  surface = makeFramebuffer(gl, {&normal}, &depth);
  background = makeTexture(gl, thicknessWidth, thicknessHeight, kFloat1, GL_NEAREST);
  backgroundTarget = makeFramebuffer(gl, {&background}, nullptr);
  for (int i = 0; i < 2; ++i) {
    thickness[i] = makeTexture(gl, thicknessWidth, thicknessHeight, kFloat2, GL_LINEAR);
    thicknessTargets[i] = makeFramebuffer(gl, {&thickness[i]}, nullptr);
    nearness[i] = makeTexture(gl, width, height, kFloat1, GL_NEAREST);
    nearnessTargets[i] = makeFramebuffer(gl, {&nearness[i]}, nullptr);
  }
  scene = makeTexture(gl, width, height, kColor16F, GL_LINEAR);
  sceneTarget = makeFramebuffer(gl, {&scene}, nullptr);
  shaded = makeTexture(gl, width, height, kColor16F, GL_NEAREST);
  shadedTarget = makeFramebuffer(gl, {&shaded}, nullptr);
}

WaterSmoothing::WaterSmoothing(const Functions& gl)
    : gl_(gl),
      gather_(gl, "water_nearness.frag"),
      narrowRange_(gl, "water_narrow_range.frag"),
      polish_(gl, "water_polish.frag"),
      blur_(gl, "water_thickness_blur.frag") {}

void WaterSmoothing::smoothSurface(const Frame& frame, const WaterTargets& water, float width) const {
  gl_.disable(GL_DEPTH_TEST);
  gl_.viewport(0, 0, frame.view.width, frame.view.height);
  gl_.bindFramebuffer(GL_FRAMEBUFFER, water.nearnessTargets[0].name());
  gather_.use();
  setCameraUniforms(gather_, frame.camera, frame.width, frame.height);
  gather_.setTexture("uDepth", 0, water.depth);
  gather_.setTexture("uNormal", 1, water.normal);
  gather_.set("uSamples", frame.samples);
  gather_.draw();

  narrowRange_.use();
  const float pixels = 0.5f * float(frame.view.height) / frame.camera.tangent.y;  // of 1 m at 1 m
  narrowRange_.set("uRange", 2.5f * width);
  // The narrower rounds take away the streaks that the axes of the wider ones leave.
  for (const float share : {1.0f, 0.5f, 0.25f})
    for (int axis = 0; axis < 2; ++axis) {
      gl_.bindFramebuffer(GL_FRAMEBUFFER, water.nearnessTargets[1 - axis].name());
      narrowRange_.setTexture("uNearness", 0, water.nearness[axis]);
      narrowRange_.set("uStepX", axis == 0 ? 1 : 0);
      narrowRange_.set("uWidth", share * width * pixels);
      narrowRange_.draw();
    }
  gl_.bindFramebuffer(GL_FRAMEBUFFER, water.nearnessTargets[1].name());
  polish_.use();
  polish_.setTexture("uNearness", 0, water.nearness[0]);
  polish_.set("uRange", width);
  polish_.draw();
}

void WaterSmoothing::smoothThickness(const Frame& frame, const WaterTargets& water, float width) const {
  gl_.disable(GL_DEPTH_TEST);
  gl_.viewport(0, 0, water.thicknessWidth, water.thicknessHeight);
  blur_.use();
  blur_.set("uWidth", width * 0.5f * float(water.thicknessHeight) / frame.camera.tangent.y);
  blur_.setTexture("uNearness", 1, water.nearness[1]);
  for (int axis = 0; axis < 2; ++axis) {
    gl_.bindFramebuffer(GL_FRAMEBUFFER, water.thicknessTargets[1 - axis].name());
    blur_.setTexture("uThickness", 0, water.thickness[axis]);
    blur_.set("uStepX", axis == 0 ? 1 : 0);
    blur_.draw();
  }
}

}  // namespace weir::rendering::gl
