#include "plugins/rendering/gl/occlusion_pass.h"

#include <array>

namespace weir::rendering::gl {
OcclusionPass::OcclusionPass(const Functions& gl)
    : gl_(gl), estimate_(gl, "occlusion.frag"), blur_(gl, "occlusion_blur.frag") {}

void OcclusionPass::draw(const Frame& frame, const Targets& targets, const ShadedOcclusion& occlusion) const {
  gl_.disable(GL_DEPTH_TEST);
  gl_.viewport(0, 0, targets.pictureWidth, targets.pictureHeight);

  gl_.bindFramebuffer(GL_FRAMEBUFFER, targets.occlusionTargets[0].name());
  estimate_.use();
  setCameraUniforms(estimate_, frame.camera, frame.width, frame.height);
  estimate_.setTexture("uDepth", 0, targets.depth);
  estimate_.setTexture("uNormal", 1, targets.normal);
  estimate_.set("uSamples", frame.samples);
  estimate_.set("uRadius", occlusion.radius);
  estimate_.set("uRadiusInView", occlusion.radiusInView);
  estimate_.set("uLargest", occlusion.largest);
  estimate_.draw();

  blur_.use();
  setCameraUniforms(blur_, frame.camera, frame.width, frame.height);
  blur_.setTexture("uDepth", 0, targets.depth);
  blur_.set("uSamples", frame.samples);
  blur_.set("uRadius", occlusion.radius);
  for (int axis = 0; axis < 2; ++axis) {
    gl_.bindFramebuffer(GL_FRAMEBUFFER, targets.occlusionTargets[1 - axis].name());
    blur_.setTexture("uOpen", 1, targets.occlusion[axis]);
    blur_.set("uStepX", axis == 0 ? 1 : 0);
    blur_.draw();
  }
}

void OcclusionPass::clear(const Targets& targets) const {
  constexpr std::array<float, 4> kOpen{1, 1, 1, 1};
  gl_.bindFramebuffer(GL_FRAMEBUFFER, targets.occlusionTargets[0].name());
  gl_.clearBufferfv(GL_COLOR, 0, kOpen.data());
}

}  // namespace weir::rendering::gl
