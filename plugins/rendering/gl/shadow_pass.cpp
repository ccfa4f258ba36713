#include "plugins/rendering/gl/shadow_pass.h"

#include <array>

#include "plugins/rendering/gl/surface_pass.h"

namespace weir::rendering::gl {
ShadowPass::ShadowPass(const Functions& gl)
    : gl_(gl),
      opaque_(gl, "shadow.vert", "shadow.frag"),
      glass_(gl, "shadow.vert", "shadow_glass.frag"),
      depth_(makeTexture(gl, kShadowResolution, kShadowResolution, kDepth32F, GL_LINEAR)),
      throughGlass_(makeTexture(gl, kShadowResolution, kShadowResolution, kColor8, GL_LINEAR)),
      depthTarget_(makeFramebuffer(gl, {}, &depth_)),
      glassTarget_(makeFramebuffer(gl, {&throughGlass_}, &depth_)) {
  gl.bindTexture(GL_TEXTURE_2D, depth_.name());
  gl.texParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
  gl.texParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
}

void ShadowPass::draw(const Frame& frame, const MeshStore& meshes, ParticleDrawer& particles) {
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
  constexpr float kFarthest = 1;
  constexpr std::array<float, 4> kAllLight{1, 1, 1, 1};
  gl_.viewport(0, 0, kShadowResolution, kShadowResolution);
  gl_.enable(GL_DEPTH_TEST);
  gl_.depthMask(GL_TRUE);
  gl_.bindFramebuffer(GL_FRAMEBUFFER, depthTarget_.name());
  gl_.clearBufferfv(GL_DEPTH, 0, &kFarthest);
  particles.drawShadow(frame.sun, depth_, kShadowResolution);
  drawSurfaces(opaque_, false);

  gl_.bindFramebuffer(GL_FRAMEBUFFER, glassTarget_.name());
  gl_.clearBufferfv(GL_COLOR, 0, kAllLight.data());
  gl_.depthMask(GL_FALSE);
  gl_.enable(GL_BLEND);
  gl_.blendFunc(GL_DST_COLOR, GL_ZERO);
  drawSurfaces(glass_, true);
  gl_.disable(GL_BLEND);
  gl_.depthMask(GL_TRUE);
}

}  // namespace weir::rendering::gl
