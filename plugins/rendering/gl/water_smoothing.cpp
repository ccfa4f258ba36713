#include "plugins/rendering/gl/water_smoothing.h"

namespace weir::rendering::gl {
WaterTargets::WaterTargets(const Functions& gl, const Targets& targets)
    : depth(gl, targets.depth.width, targets.depth.height, kDepth32F, GL_NEAREST),
      normal(gl, targets.depth.width, targets.depth.height, kColor16, GL_NEAREST),
      surface(gl, {&normal}, &depth) {
  const int width = targets.pictureWidth, height = targets.pictureHeight;
  const int halfWidth = (width + 1) / 2, halfHeight = (height + 1) / 2;
  background = Canvas(gl, halfWidth, halfHeight, kFloat1, GL_NEAREST);
  for (Canvas& canvas : thickness) canvas = Canvas(gl, halfWidth, halfHeight, kFloat2, GL_LINEAR);
  for (Canvas& canvas : nearness) canvas = Canvas(gl, width, height, kFloat1, GL_NEAREST);
  scene = Canvas(gl, width, height, kColor16F, GL_LINEAR);
  shaded = Canvas(gl, width, height, kColor16F, GL_NEAREST);
}

WaterSmoothing::WaterSmoothing(const Functions& gl)
    : gather_(gl, "water_nearness.frag"),
      narrowRange_(gl, "water_narrow_range.frag"),
      polish_(gl, "water_polish.frag"),
      blur_(gl, "water_thickness_blur.frag") {}

void WaterSmoothing::smoothSurface(const Frame& frame, const WaterTargets& water, float width) const {
  gather_.use();
  setCameraUniforms(gather_, frame.camera, frame.width, frame.height);
  gather_.setTexture("uDepth", water.depth);
  gather_.setTexture("uNormal", water.normal);
  gather_.set("uSamples", frame.samples);
  gather_.draw(water.nearness[0].target);

  narrowRange_.use();
  const float pixels = 0.5f * float(frame.view.height) / frame.camera.tangent.y;  // of 1 m at 1 m
  narrowRange_.set("uRange", 2.5f * width);
  // The narrower rounds take away the streaks that the axes of the wider ones leave.
  for (const float share : {1.0f, 0.5f, 0.25f})
    for (int axis = 0; axis < 2; ++axis) {
      narrowRange_.setTexture("uNearness", water.nearness[axis].texture);
      narrowRange_.set("uStepX", axis == 0 ? 1 : 0);
      narrowRange_.set("uWidth", width * pixels);
      narrowRange_.set("uShare", share);
      narrowRange_.draw(water.nearness[1 - axis].target);
    }
  polish_.use();
  polish_.setTexture("uNearness", water.nearness[0].texture);
  polish_.set("uRange", width);
  polish_.draw(water.nearness[1].target);
}

void WaterSmoothing::smoothThickness(const Frame& frame, const WaterTargets& water, float width) const {
  blur_.use();
  blur_.set("uWidth", width * 0.5f * float(water.thickness[0].texture.height) / frame.camera.tangent.y);
  blur_.setTexture("uNearness", water.nearness[1].texture);
  for (int axis = 0; axis < 2; ++axis) {
    blur_.setTexture("uThickness", water.thickness[axis].texture);
    blur_.set("uStepX", axis == 0 ? 1 : 0);
    blur_.draw(water.thickness[1 - axis].target);
  }
}

}  // namespace weir::rendering::gl
