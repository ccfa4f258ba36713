#include "plugins/rendering/gl/glass_pass.h"

#include <algorithm>
#include <vector>

#include "plugins/rendering/gl/surface_pass.h"

namespace weir::rendering::gl {

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

  targets.lightWithDepth.bind();
  // A little nearer, so that the foot of a glass is seen on the ground it stands on.
  gl_.enable(GL_POLYGON_OFFSET_FILL);
  gl_.polygonOffset(-1, -64);
  program_.use();
  setLightUniforms(program_, frame);
  program_.setMatrix4("uToClip", frame.camera.projection().eval().data());
  setGridUniform(program_, frame.width, frame.height);
  setBehindUniforms(program_, frame, before);
  environment.setUniforms(program_, frame);
  program_.set("uOutside", int(hasSurroundings(frame.view)));
  program_.set("uUnlit", int(frame.view.lighting.unlit));
  for (const SurfaceView* surface : glass) {
    setPlacement(program_, frame.camera, *surface);
    program_.set("uTint", linear(surface->color));
    for (const GLenum hidden : {GL_FRONT, GL_BACK}) {
      setState(gl_, {.depthTest = GL_LEQUAL,
                     .writesDepth = false,
                     .source = GL_ONE,
                     .destination = GL_SRC1_COLOR,
                     .culled = hidden});
      meshes.draw(surface->mesh);
    }
  }
  gl_.disable(GL_POLYGON_OFFSET_FILL);
}

}  // namespace weir::rendering::gl
