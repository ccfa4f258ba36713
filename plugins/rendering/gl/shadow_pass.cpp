#include "plugins/rendering/gl/shadow_pass.h"

#include "plugins/rendering/gl/surface_pass.h"

namespace weir::rendering::gl {

void ShadowPass::draw(const Frame& frame, const MeshStore& meshes, SphereDrawer& particles) {
  const Eigen::Matrix4f toClip = frame.sun.toClip();
  const auto drawSurfaces = [&](const Program& program, bool glass) {
    program.use();
    setGridUniform(program, kShadowResolution, kShadowResolution);
    for (const SurfaceView& surface : frame.view.surfaces) {
      if (surface.look == SurfaceLook::kWater) continue;
      if ((surface.look == SurfaceLook::kGlass) != glass) continue;
      const Eigen::Matrix4f placement = placementOf(surface);
      const Eigen::Matrix3f normalToSun = (frame.sun.view * placement).topLeftCorner<3, 3>();
      program.setMatrix4("uToClip", (toClip * placement).eval().data());
      program.setMatrix3("uNormalToSun", normalToSun.data());
      program.set("uTint", linear(surface.color));
      meshes.draw(surface.mesh);
    }
  };
  depthTarget_.clearDepth();
  setState(gl_, {.depthTest = GL_LEQUAL});
  particles.drawSunDepth(frame.sun, {}, depth_);
  drawSurfaces(opaque_, false);

  glassTarget_.clearColor(0, {1, 1, 1, 1});
  setState(gl_, {.depthTest = GL_LEQUAL, .writesDepth = false, .source = GL_DST_COLOR});
  drawSurfaces(glass_, true);
}

}  // namespace weir::rendering::gl
