#include "plugins/rendering/gl/glass_pass.h"

#include <algorithm>
#include <vector>

#include "plugins/rendering/gl/surface_pass.h"

namespace weir::rendering::gl {
GlassPass::GlassPass(const Functions& gl) : gl_(gl), program_(gl, "surface.vert", "glass.frag") {}

void GlassPass::draw(const Frame& frame, const Targets& targets, const MeshStore& meshes,
                     const Texture& before, const Environment& environment) const {
  std::vector<const SurfaceView*> glass;
  for (const SurfaceView& surface : frame.view.surfaces)
    if (surface.look == SurfaceLook::kGlass) glass.push_back(&surface);
  if (glass.empty()) return;
  const auto distance = [&](const SurfaceView* surface) {
    return length(placedBounds(meshes.bounds(surface->mesh), *surface).center() - frame.view.camera.eye);
  };
  std::stable_sort(glass.begin(), glass.end(),
                   [&](const auto* a, const auto* b) { return distance(a) > distance(b); });

  gl_.viewport(0, 0, frame.width, frame.height);
  gl_.bindFramebuffer(GL_FRAMEBUFFER, targets.lightWithDepth.name());
  gl_.enable(GL_DEPTH_TEST);
  gl_.depthMask(GL_FALSE);
  gl_.enable(GL_BLEND);
  gl_.blendFunc(GL_ONE, GL_SRC1_COLOR);
  gl_.enable(GL_CULL_FACE);
  // A little nearer, so that the foot of a glass is seen on the ground it stands on.
  gl_.enable(GL_POLYGON_OFFSET_FILL);
  gl_.polygonOffset(-1, -64);
  program_.use();
  setLightUniforms(program_, frame);
  program_.setMatrix4("uToClip", frame.camera.projection().eval().data());
  setGridUniform(program_, frame.width, frame.height);
  setBehindUniforms(program_, frame, before, 0);
  environment.setUniforms(program_, frame, 1);
  program_.set("uOutside", int(hasSurroundings(frame.view)));
  program_.set("uUnlit", int(frame.view.lighting.unlit));
  for (const SurfaceView* surface : glass) {
    setPlacement(program_, frame.camera, *surface);
    program_.set("uTint", linear(surface->color));
    for (const GLenum hidden : {GL_FRONT, GL_BACK}) {
      gl_.cullFace(hidden);
      meshes.draw(surface->mesh);
    }
  }
  gl_.disable(GL_POLYGON_OFFSET_FILL);
  gl_.disable(GL_CULL_FACE);
  gl_.disable(GL_BLEND);
  // Mesa 22 refuses to draw into two targets while two sources are set, even if they are not in use.
  gl_.blendFunc(GL_ONE, GL_ZERO);
  gl_.depthMask(GL_TRUE);
}

}  // namespace weir::rendering::gl
