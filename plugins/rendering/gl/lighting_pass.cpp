#include "plugins/rendering/gl/lighting_pass.h"

#include <algorithm>

#include "plugins/rendering/gl/sunlight.h"

namespace weir::rendering::gl {
LightingPass::LightingPass(const Functions& gl) : gl_(gl), resolve_(gl, "picture.frag") {}

const FullScreenProgram& LightingPass::programFor(const Frame& frame) {
  const auto& surfaces = frame.view.surfaces;
  std::string defines = sunlightDefines(frame);
  if (std::any_of(surfaces.begin(), surfaces.end(),
                  [](const SurfaceView& surface) { return surface.look == SurfaceLook::kMetal; }))
    defines += "#define METAL\n";
  if (isOutside(frame.view)) defines += "#define OUTSIDE\n";
  if (hasSurroundings(frame.view)) defines += "#define MIRRORS\n";
  if (frame.view.ground.visible && frame.view.ground.tiles > 0) defines += "#define TILES\n";
  const auto known = lighting_.find(defines);
  if (known != lighting_.end()) return known->second;
  return lighting_.emplace(defines, FullScreenProgram(gl_, "lighting.frag", defines)).first->second;
}

void LightingPass::draw(const Frame& frame, const Targets& targets, const ShadowPass& shadows,
                        const WaterShadow* water, const Environment& environment) {
  const FullScreenProgram& lighting = programFor(frame);
  const View& view = frame.view;
  gl_.disable(GL_DEPTH_TEST);
  gl_.viewport(0, 0, frame.width, frame.height);
  gl_.bindFramebuffer(GL_FRAMEBUFFER, targets.lighting.name());
  lighting.use();
  setCameraUniforms(lighting, frame.camera, frame.width, frame.height);
  setLightUniforms(lighting, frame);
  lighting.setTexture("uAlbedo", 0, targets.albedo);
  lighting.setTexture("uNormal", 1, targets.normal);
  lighting.setTexture("uDepth", 2, targets.depth);
  lighting.setTexture("uOcclusion", 3, targets.occlusion[0]);
  setSunlightUniforms(lighting, frame, shadows, water, 4);
  environment.setUniforms(lighting, frame, 8);
  lighting.set("uBackgroundTop", linear(view.backgroundTop));
  lighting.set("uBackgroundBottom", linear(view.backgroundBottom));
  lighting.set("uGroundMiddle", frame.camera.point(groundMiddle(view)));
  lighting.set("uGroundRadius", view.ground.radius);
  lighting.set("uTiles", view.ground.tiles);
  lighting.setMatrix3("uToWorld", environment.fromCamera(frame).eval().data());
  lighting.set("uUnlit", int(view.lighting.unlit));
  lighting.set("uTransparent", int(view.transparent));
  lighting.draw();
}

void LightingPass::resolve(const Frame& frame, const Targets& targets) const {
  gl_.disable(GL_DEPTH_TEST);
  gl_.viewport(0, 0, targets.pictureWidth, targets.pictureHeight);
  gl_.bindFramebuffer(GL_FRAMEBUFFER, targets.pictureTarget.name());
  resolve_.use();
  resolve_.setTexture("uLight", 0, targets.light);
  resolve_.set("uSamples", frame.samples);
  resolve_.set("uHeight", targets.pictureHeight);
  resolve_.set("uFilmic", int(frame.view.lighting.tone == ToneCurve::kFilmic));
  resolve_.set("uExposure", frame.view.lighting.exposure);
  resolve_.set("uUnlit", int(frame.view.lighting.unlit));
  resolve_.draw();
}

}  // namespace weir::rendering::gl
