#include "plugins/rendering/gl/water_surface_pass.h"

#include "plugins/rendering/gl/surface_pass.h"

namespace weir::rendering::gl {
WaterSurfacePass::WaterSurfacePass(const Functions& gl)
    : gl_(gl),
      surface_(gl, "surface.vert", "water_surface.frag"),
      thickness_(gl, "surface.vert", "water_inside.frag") {}

void WaterSurfacePass::draw(const Frame& frame, const Program& program, std::size_t water,
                            const MeshStore& meshes, const Vec2i& size, bool fromSun) const {
  const Eigen::Matrix4f toClip = fromSun ? frame.sun.toClip() : frame.camera.projection();
  program.use();
  program.setMatrix4("uToClip", toClip.data());
  setGridUniform(program, size.x, size.y);
  program.set("uDepthRange", fromSun ? frame.sun.zNearest - frame.sun.zFarthest : 0.0f);
  for (const SurfaceView& surface : frame.view.surfaces) {
    if (surface.look != SurfaceLook::kWater || surface.water != water) continue;
    if (fromSun) {
      const Eigen::Matrix4f placement = placementOf(surface);
      program.setMatrix4("uToView", placement.data());
    } else {
      setPlacement(program, frame.camera, surface);
    }
    meshes.draw(surface.mesh);
  }
}

void WaterSurfacePass::addThickness(const Frame& frame, std::size_t water, const MeshStore& meshes,
                                    const Vec2i& size, bool fromSun) const {
  gl_.enable(GL_BLEND);
  gl_.blendFunc(GL_ONE, GL_ONE);
  draw(frame, thickness_, water, meshes, size, fromSun);
  gl_.disable(GL_BLEND);
  gl_.blendFunc(GL_ONE, GL_ZERO);
}

void WaterSurfacePass::drawDepth(const Frame& frame, std::size_t water, const MeshStore& meshes,
                                 const Vec2i& size) const {
  draw(frame, surface_, water, meshes, size, false);
}

void WaterSurfacePass::drawThickness(const Frame& frame, std::size_t water, const MeshStore& meshes,
                                     const Vec2i& size) const {
  addThickness(frame, water, meshes, size, false);
}

void WaterSurfacePass::drawSunDepth(const Frame& frame, std::size_t water, const MeshStore& meshes,
                                    const Vec2i& size) const {
  draw(frame, surface_, water, meshes, size, true);
}

void WaterSurfacePass::drawSunThickness(const Frame& frame, std::size_t water, const MeshStore& meshes,
                                        const Vec2i& size) const {
  addThickness(frame, water, meshes, size, true);
}

}  // namespace weir::rendering::gl
