#include "plugins/rendering/gl/occlusion_pass.h"

namespace weir::rendering::gl {
OcclusionPass::OcclusionPass(const Functions& gl)
    : estimate_(gl, "occlusion.frag"), blur_(gl, "occlusion_blur.frag") {}

static void use(const Program& program, const Frame& frame, const Targets& targets, float radius) {
  program.use();
  setCameraUniforms(program, frame.camera, frame.width, frame.height);
  program.setTexture("uDepth", targets.depth);
  program.set("uSamples", frame.samples);
  program.set("uRadius", radius);
}

void OcclusionPass::draw(const Frame& frame, const Targets& targets, const ShadedOcclusion& occlusion) const {
  use(estimate_, frame, targets, occlusion.radius);
  estimate_.setTexture("uNormal", targets.normal);
  estimate_.set("uRadiusInView", occlusion.radiusInView);
  estimate_.set("uLargest", occlusion.largest);
  estimate_.draw(targets.occlusion[0].target);

  use(blur_, frame, targets, occlusion.radius);
  for (int axis = 0; axis < 2; ++axis) {
    blur_.setTexture("uOpen", targets.occlusion[axis].texture);
    blur_.set("uStepX", axis == 0 ? 1 : 0);
    blur_.draw(targets.occlusion[1 - axis].target);
  }
}

void OcclusionPass::clear(const Targets& targets) const {
  targets.occlusion[0].target.clearColor(0, {1, 1, 1, 1});
}

}  // namespace weir::rendering::gl
