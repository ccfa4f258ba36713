#include "plugins/rendering/gl/sunlight.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "plugins/rendering/gl/shaders.h"

namespace weir::rendering::gl {
namespace {

/// A sunflower's seeds (H. Vogel 1979): evenly spread.
Vec2f sunflower(int number, int count) {
  constexpr float kGoldenAngle = 2.3999632f;
  const float radius = std::sqrt((float(number) + 0.5f) / float(count));
  return {radius * std::cos(float(number) * kGoldenAngle), radius * std::sin(float(number) * kGoldenAngle)};
}

/// Cosine and sine of angles between which the taps' own places are evenly turned.
Vec2f quarterStep(int number, int count) {
  const float angle = 0.5f * std::numbers::pi_v<float> * float(number) / float(count);
  return {std::cos(angle), std::sin(angle)};
}

// Each sample looks at four places of the shadow map, turned by another angle in each of four neighbouring
// samples, so that a pixel of 2x2 samples sees sixteen.
const std::string kSnippet = R"(
uniform sampler2DShadow uShadow;
uniform sampler2D uThroughGlass;
uniform sampler2DShadow uWaterDepth;
uniform sampler2D uThroughWater;
uniform mat4 uToSun;        // from camera space to the shadow map
uniform float uSoftness;    // radius of the edges, in the shadow map's coordinates
uniform float uShadowTexel; // m

vec3 sunlight(vec3 position, vec3 normal, float throughGlass, bool underWater) {
#ifdef SHADOWS
  vec4 place = uToSun * vec4(position + normal * uShadowTexel * 2.0, 1.0);
  place.z = min(place.z, 1.0);
  ivec2 odd = ivec2(gl_FragCoord.xy) & 1;
  vec2 turn = uSoftness * kTurns[odd.x + 2 * odd.y];
  float open = 0.0;
  for (int i = 0; i < 4; ++i) {
    vec2 offset = vec2(kTaps[i].x * turn.x - kTaps[i].y * turn.y, kTaps[i].x * turn.y + kTaps[i].y * turn.x);
    open += 0.25 * textureLod(uShadow, place.xyz + vec3(offset, 0.0), 0.0);
  }
  vec3 light = vec3(open);
#ifdef GLASS
  light *= mix(vec3(1.0), textureLod(uThroughGlass, place.xy + 0.7 * turn, 0.0).rgb, throughGlass);
#endif
#ifdef WATER
  if (underWater) {
    float above = textureLod(uWaterDepth, place.xyz + vec3(0.7 * turn, 0.0), 0.0);
    light *= mix(textureLod(uThroughWater, place.xy + 0.7 * turn, 0.0).rgb, vec3(1.0), above);
  }
#endif
  return light;
#else
  return vec3(1.0);
#endif
}
)";

}  // namespace

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

const std::string& sunlightSnippet() {
  static const std::string snippet =
      placesInCircle("kTaps", 4, sunflower) + placesInCircle("kTurns", 4, quarterStep) + kSnippet;
  return snippet;
}

void setSunlightUniforms(const Program& program, const Frame& frame, const ShadowPass& shadows,
                         const WaterShadow* water, int unit) {
  program.setTexture("uShadow", unit, shadows.depth());
  program.setTexture("uThroughGlass", unit + 1, shadows.throughGlass());
  if (water != nullptr) {
    program.setTexture("uWaterDepth", unit + 2, water->depth());
    program.setTexture("uThroughWater", unit + 3, water->through());
  }
  if (!frame.hasShadows) return;
  const Eigen::Matrix4f toSun = frame.sun.toTexture() * frame.camera.view.inverse();
  program.setMatrix4("uToSun", toSun.data());
  program.set("uShadowTexel", 2 * frame.sun.halfSize / float(ShadowPass::kResolution));
  constexpr float kSoftTexels = 5;
  program.set("uSoftness", kSoftTexels / float(ShadowPass::kResolution));
}

}  // namespace weir::rendering::gl
