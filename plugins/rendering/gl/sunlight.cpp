#include "plugins/rendering/gl/sunlight.h"

#include <algorithm>

namespace weir::rendering::gl {
std::string sunlightDefines(const Frame& frame) {
  const auto has = [&](SurfaceLook look) {
    return std::any_of(frame.view.surfaces.begin(), frame.view.surfaces.end(),
                       [&](const SurfaceView& surface) { return surface.look == look; });
  };
  std::string defines;
  if (frame.hasShadows) defines += "#define SHADOWS\n";
  if (has(SurfaceLook::kGlass)) defines += "#define GLASS\n";
  if (!frame.view.waters.empty()) defines += "#define WATER\n";
  return defines;
}

void setSunlightUniforms(const Program& program, const Frame& frame, const ShadowPass& shadows,
                         const WaterShadow* water) {
  program.setTexture("uShadow", shadows.depth());
  program.setTexture("uThroughGlass", shadows.throughGlass());
  if (water != nullptr) {
    program.setTexture("uWaterDepth", water->depth());
    program.setTexture("uThroughWater", water->through());
  }
  if (!frame.hasShadows) return;
  const ShadedLight light = lightOf(frame);
  program.setMatrix4("uToSun", toShadowMap(frame).data());
  program.setMatrix3("uSlopeToSun", slopeToShadowMap(frame).data());
  program.set("uShadowTexel", light.shadowTexel);
  program.set("uSoftness", light.softness);
}

}  // namespace weir::rendering::gl
