#include "plugins/rendering/gl/glass_pass.h"

#include <algorithm>
#include <vector>

#include "plugins/rendering/gl/shaders.h"
#include "plugins/rendering/gl/surface_pass.h"

namespace weir::rendering::gl {
namespace {

// Two outputs for one target: the light that is added, and the part of the light behind that comes through.
const std::string kFragmentShader =
    kShaderVersion + kBehindSnippet + kLightSnippet + kEnvironmentSnippet + R"(
uniform vec3 uTint;
uniform bool uUnlit, uOutside;
in vec3 vNormal;
in vec3 vPosition;
layout(location = 0, index = 0) out vec4 oAdded;
layout(location = 0, index = 1) out vec4 oThrough;

void main() {
  leaveUnlessBehind();
  vec3 towardsEye = -normalize(vPosition);
  vec3 normal = normalize(vNormal);
  if (!gl_FrontFacing) normal = -normal;
  float cosine = max(dot(normal, towardsEye), 0.0);
  float mirror = fresnel(cosine, 0.04);
  // The way through a thin wall is longer at a flat angle, where real glass bends in light from darker places too.
  vec3 through = pow(uTint, vec3(0.1 / max(cosine, 0.15))) * (1.0 - 0.45 * pow(1.0 - cosine, 3.0));
  vec3 surroundings = uOutside ? environment(reflect(-towardsEye, normal))
                               : reflectedLight(reflect(-towardsEye, normal), 2.6);
  vec3 mirrored = surroundings + 0.35 * uSunColor * highlight(normal, towardsEye, 300.0);
  float seen = gl_FrontFacing ? 1.0 : 0.45;  // inner sides mirror less: their light crosses the wall twice
  through *= 1.0 - mirror * seen;
  float clear = dot(through, vec3(1.0 / 3.0));
  oAdded = vec4(uUnlit ? vec3(0.0) : seen * mirror * mirrored, 1.0 - clear);
  oThrough = vec4(through, clear);
}
)";

}  // namespace

GlassPass::GlassPass(const Functions& gl)
    : gl_(gl), program_(gl, "glass", kSurfaceVertexShader, kFragmentShader) {}

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
