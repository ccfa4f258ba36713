#include "plugins/rendering/gl/lighting_pass.h"

#include <algorithm>

#include "plugins/rendering/gl/sunlight.h"

namespace weir::rendering::gl {
LightingPass::LightingPass(const Functions& gl)
    : resolve_(gl, "picture.frag"), lighting_(gl, "lighting.frag") {}

const FullScreenProgram& LightingPass::programFor(const Frame& frame) {
  const auto& surfaces = frame.view.surfaces;
  std::string defines = sunlightDefines(frame);
  if (std::any_of(surfaces.begin(), surfaces.end(),
                  [](const SurfaceView& surface) { return surface.look == SurfaceLook::kMetal; }))
    defines += "#define METAL\n";
  if (isOutside(frame.view)) defines += "#define OUTSIDE\n";
  if (hasSurroundings(frame.view)) defines += "#define MIRRORS\n";
  if (frame.view.ground.visible && frame.view.ground.tiles > 0) defines += "#define TILES\n";
  return lighting_.with(defines);
}

void LightingPass::draw(const Frame& frame, const Targets& targets, const ShadowPass& shadows,
                        const WaterShadow* water, const Environment& environment) {
  const FullScreenProgram& lighting = programFor(frame);
  const View& view = frame.view;
  lighting.use();
  setCameraUniforms(lighting, frame.camera, frame.width, frame.height);
  setLightUniforms(lighting, frame);
  lighting.setTexture("uAlbedo", targets.albedo);
  lighting.setTexture("uNormal", targets.normal);
  lighting.setTexture("uDepth", targets.depth);
  lighting.setTexture("uOcclusion", targets.occlusion[0].texture);
  setSunlightUniforms(lighting, frame, shadows, water);
  environment.setUniforms(lighting, frame);
  lighting.set("uBackgroundTop", linear(view.backgroundTop));
  lighting.set("uBackgroundBottom", linear(view.backgroundBottom));
  lighting.set("uGroundMiddle", frame.camera.point(groundMiddle(view)));
  lighting.set("uGroundRadius", view.ground.radius);
  lighting.set("uTiles", view.ground.tiles);
  lighting.setMatrix3("uToWorld", toSurroundings(frame).data());
  lighting.set("uUnlit", int(view.lighting.unlit));
  lighting.set("uTransparent", int(view.transparent));
  lighting.draw(targets.light.target);
}

void LightingPass::resolve(const Frame& frame, const Targets& targets) const {
  resolve_.use();
  resolve_.setTexture("uLight", targets.light.texture);
  resolve_.set("uSamples", frame.samples);
  resolve_.set("uHeight", targets.pictureHeight);
  resolve_.set("uFilmic", int(frame.view.lighting.tone == ToneCurve::kFilmic));
  resolve_.set("uExposure", frame.view.lighting.exposure);
  resolve_.set("uUnlit", int(frame.view.lighting.unlit));
  resolve_.draw(targets.picture.target);
}

}  // namespace weir::rendering::gl
