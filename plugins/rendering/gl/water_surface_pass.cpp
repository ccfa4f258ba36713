#include "plugins/rendering/gl/water_surface_pass.h"

#include "plugins/rendering/gl/shaders.h"
#include "plugins/rendering/gl/surface_pass.h"

namespace weir::rendering::gl {
namespace {

const std::string kSurfaceFragmentShader = kShaderVersion + R"(
in vec3 vNormal;
in vec3 vPosition;
layout(location = 0) out vec4 oNormal;

void main() {
  vec3 normal = normalize(vNormal);
  if (!gl_FrontFacing) normal = -normal;
  oNormal = vec4(0.5 + 0.5 * normal, 1.0);
}
)";

const std::string kThicknessFragmentShader = kShaderVersion + R"(
uniform float uDepthRange;  // m; 0 for a camera
in vec3 vNormal;
in vec3 vPosition;
layout(location = 0) out vec2 oThickness;

void main() {
  float along = uDepthRange > 0.0 ? uDepthRange * gl_FragCoord.z : length(vPosition);
  oThickness = vec2(gl_FrontFacing ? -along : along, 0.0);
}
)";

}  // namespace

WaterSurfacePass::WaterSurfacePass(const Functions& gl)
    : gl_(gl),
      surface_(gl, "surfaces of a liquid", kSurfaceVertexShader, kSurfaceFragmentShader),
      thickness_(gl, "insides of a liquid", kSurfaceVertexShader, kThicknessFragmentShader) {}

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
