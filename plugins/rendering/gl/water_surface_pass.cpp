#include "plugins/rendering/gl/water_surface_pass.h"

#include "plugins/rendering/gl/surface_pass.h"

namespace weir::rendering::gl {

static void draw(const SeenWater& seen, const Program& program) {
  const Frame& frame = seen.frame;
  const Eigen::Matrix4f toClip = seen.fromSun ? frame.sun.toClip() : frame.camera.projection();
  program.use();
  program.setMatrix4("uToClip", toClip.data());
  setGridUniform(program, seen.size.x, seen.size.y);
  program.set("uDepthRange", seen.fromSun ? frame.sun.zNearest - frame.sun.zFarthest : 0.0f);
  for (const SurfaceView& surface : frame.view.surfaces) {
    if (surface.look != SurfaceLook::kWater || surface.water != seen.water) continue;
    if (seen.fromSun)
      program.setMatrix4("uToView", placementOf(surface).data());
    else
      setPlacement(program, frame.camera, surface);
    seen.meshes.draw(surface.mesh);
  }
}

void WaterSurfacePass::drawDepth(const SeenWater& seen) const {
  setState(gl_, {.depthTest = GL_LEQUAL});
  draw(seen, surface_);
}

void WaterSurfacePass::drawThickness(const SeenWater& seen) const {
  setState(gl_, {.source = GL_ONE, .destination = GL_ONE});
  draw(seen, thickness_);
}

}  // namespace weir::rendering::gl
