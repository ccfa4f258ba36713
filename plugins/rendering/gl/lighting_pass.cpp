#include "plugins/rendering/gl/lighting_pass.h"

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

// Each sample looks at four places of the shadow map, turned by another angle in each of four neighbouring
// samples, so that a pixel of 2x2 samples sees sixteen.
const std::string kShadowSnippet = R"(
uniform sampler2DShadow uShadow;
uniform sampler2D uThroughGlass;
uniform mat4 uToSun;        // from camera space to the shadow map
uniform float uSoftness;    // radius of the edges, in the shadow map's coordinates
uniform float uShadowTexel; // m

vec3 sunlight(vec3 position, vec3 normal, float throughGlass) {
#ifdef SHADOWS
  vec4 place = uToSun * vec4(position + normal * uShadowTexel * 2.0, 1.0);
  place.z = min(place.z, 1.0);
  ivec2 odd = ivec2(gl_FragCoord.xy) & 1;
  vec2 turn = uSoftness * kTurns[odd.x + 2 * odd.y];
  float open = 0.0;
  for (int i = 0; i < 4; ++i) {
    vec2 offset = vec2(kTaps[i].x * turn.x - kTaps[i].y * turn.y, kTaps[i].x * turn.y + kTaps[i].y * turn.x);
    open += 0.25 * texture(uShadow, place.xyz + vec3(offset, 0.0));
  }
#ifdef GLASS
  return open * mix(vec3(1.0), texture(uThroughGlass, place.xy + 0.7 * turn).rgb, throughGlass);
#endif
  return vec3(open);
#else
  return vec3(1.0);
#endif
}
)";

/// Cosine and sine of angles between which the taps' own places are evenly turned.
Vec2f quarterStep(int number, int count) {
  const float angle = 0.5f * std::numbers::pi_v<float> * float(number) / float(count);
  return {std::cos(angle), std::sin(angle)};
}

const std::string kLightingShader = kCameraSnippet + kMaterialSnippet + kLightSnippet + kShadowSnippet + R"(
uniform sampler2D uAlbedo, uNormal, uDepth, uOcclusion;
uniform vec3 uBackgroundTop, uBackgroundBottom;
uniform vec3 uGroundMiddle;   // in camera space
uniform float uGroundRadius;
uniform bool uUnlit;
out vec4 oLight;

vec3 backgroundAt(float height) { return mix(uBackgroundBottom, uBackgroundTop, smoothstep(0.0, 1.0, height)); }

void main() {
  ivec2 place = ivec2(gl_FragCoord.xy);
  vec2 window = gl_FragCoord.xy * uPixel * 0.5;
  vec3 background = backgroundAt(window.y);
  float depth = texelFetch(uDepth, place, 0).r;
  vec4 surface = texelFetch(uAlbedo, place, 0);
  vec3 normal = normalize(texelFetch(uNormal, place, 0).xyz * 2.0 - 1.0);
  vec3 position = rayAt(gl_FragCoord.xy) * distanceAt(depth);
  vec3 towardsEye = -normalize(position);
  bool ground = isMaterial(surface.a, kGround), particle = isMaterial(surface.a, kParticle);

  float open = texture(uOcclusion, window).r;
  float facing = dot(normal, uSun);
  vec3 sun = sunlight(position, normal, particle ? 0.5 : 1.0);
  vec3 diffuse = skyLight(normal) * open + kSunColor * sun * max(facing, 0.0) * mix(1.0, open, 0.35);
  vec3 color = surface.rgb * diffuse;
  float rim = fresnel(dot(normal, towardsEye), 0.04);
  if (particle) color += 0.10 * kSunColor * sun * highlight(normal, towardsEye, 40.0) * step(0.0, facing) * 0.25 +
                         0.25 * rim * open * uSkyColor * surface.rgb;
#ifdef METAL
  if (isMaterial(surface.a, kMetal)) {
    vec3 mirrored = reflectedLight(reflect(-towardsEye, normal), 1.0);
    vec3 tint = mix(surface.rgb, vec3(1.0), fresnel(dot(normal, towardsEye), 0.0));
    color = 0.25 * color + tint * (0.85 * mirrored * mix(0.4, 1.0, open) +
                                   0.12 * sun * highlight(normal, towardsEye, 120.0) * step(0.0, facing));
  }
#endif
  if (uUnlit) color = surface.rgb;
  float away = length(position - uGroundMiddle) / uGroundRadius;
  if (ground) color = mix(color, background, smoothstep(0.12, 0.9, away));
  oLight = vec4(depth >= 1.0 ? background : color, 1.0);
}
)";

const std::string kResolveShader = kShaderVersion + R"(
uniform sampler2D uLight;
uniform int uSamples, uHeight;
uniform bool uUnlit;
out vec4 oColor;

// Leaves light below the knee alone, and bends what is above it towards 1.
vec3 shoulder(vec3 light) {
  const float kKnee = 0.8;
  vec3 over = max(light - kKnee, 0.0) / (1.0 - kKnee);
  return min(light, kKnee) + (1.0 - kKnee) * (1.0 - exp(-over));
}

vec3 encoded(vec3 light) {
  return mix(12.92 * light, 1.055 * pow(light, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, light));
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.x, uHeight - 1 - int(gl_FragCoord.y));
  vec3 sum = vec3(0.0);
  for (int y = 0; y < uSamples; ++y)
    for (int x = 0; x < uSamples; ++x) {
      vec3 light = texelFetch(uLight, pixel * uSamples + ivec2(x, y), 0).rgb;
      sum += uUnlit ? min(light, 1.0) : shoulder(light);
    }
  oColor = vec4(encoded(sum / float(uSamples * uSamples)), 1.0);
}
)";

}  // namespace

LightingPass::LightingPass(const Functions& gl)
    : gl_(gl),
      resolve_(gl, "resolve", kFullScreenVertexShader, kResolveShader),
      array_(makeVertexArray(gl)) {}

const Program& LightingPass::programFor(const Frame& frame) {
  const auto has = [&](SurfaceLook look) {
    return std::any_of(frame.view.surfaces.begin(), frame.view.surfaces.end(),
                       [&](const SurfaceView& surface) { return surface.look == look; });
  };
  std::string defines;
  if (frame.hasShadows) defines += "#define SHADOWS\n";
  if (has(SurfaceLook::kGlass)) defines += "#define GLASS\n";
  if (has(SurfaceLook::kMetal)) defines += "#define METAL\n";
  const auto known = lighting_.find(defines);
  if (known != lighting_.end()) return known->second;
  const std::string source = kShaderVersion + defines + placesInCircle("kTaps", 4, sunflower) +
                             placesInCircle("kTurns", 4, quarterStep) + kLightingShader;
  return lighting_.emplace(defines, Program(gl_, "lighting", kFullScreenVertexShader, source)).first->second;
}

void LightingPass::draw(const Frame& frame, const Targets& targets, const ShadowPass& shadows) {
  const Program& lighting = programFor(frame);
  const View& view = frame.view;
  gl_.disable(GL_DEPTH_TEST);
  gl_.viewport(0, 0, frame.width, frame.height);
  gl_.bindFramebuffer(GL_FRAMEBUFFER, targets.lighting.name());
  gl_.bindVertexArray(array_.name());
  lighting.use();
  setCameraUniforms(lighting, frame.camera, frame.width, frame.height);
  setLightUniforms(lighting, frame);
  lighting.setTexture("uAlbedo", 0, targets.albedo);
  lighting.setTexture("uNormal", 1, targets.normal);
  lighting.setTexture("uDepth", 2, targets.depth);
  lighting.setTexture("uOcclusion", 3, targets.occlusion[0]);
  lighting.setTexture("uShadow", 4, shadows.depth());
  lighting.setTexture("uThroughGlass", 5, shadows.throughGlass());
  if (frame.hasShadows) {
    const Eigen::Matrix4f toSun = frame.sun.toTexture() * frame.camera.view.inverse();
    lighting.setMatrix4("uToSun", toSun.data());
    lighting.set("uShadowTexel", 2 * frame.sun.halfSize / float(ShadowPass::kResolution));
    constexpr float kSoftTexels = 5;
    lighting.set("uSoftness", kSoftTexels / float(ShadowPass::kResolution));
  }
  lighting.set("uBackgroundTop", linear(view.backgroundTop));
  lighting.set("uBackgroundBottom", linear(view.backgroundBottom));
  const Vec3f up = normalized(view.worldUp);
  const GroundView& ground = view.ground;
  lighting.set("uGroundMiddle",
               frame.camera.point(ground.center + up * (ground.height - dot(ground.center, up))));
  lighting.set("uGroundRadius", ground.radius);
  lighting.set("uUnlit", int(view.lighting.unlit));
  gl_.drawArrays(GL_TRIANGLES, 0, 3);
}

void LightingPass::resolve(const Frame& frame, const Targets& targets) const {
  gl_.disable(GL_DEPTH_TEST);
  gl_.viewport(0, 0, targets.pictureWidth, targets.pictureHeight);
  gl_.bindFramebuffer(GL_FRAMEBUFFER, targets.pictureTarget.name());
  gl_.bindVertexArray(array_.name());
  resolve_.use();
  resolve_.setTexture("uLight", 0, targets.light);
  resolve_.set("uSamples", frame.samples);
  resolve_.set("uHeight", targets.pictureHeight);
  resolve_.set("uUnlit", int(frame.view.lighting.unlit));
  gl_.drawArrays(GL_TRIANGLES, 0, 3);
}

}  // namespace weir::rendering::gl
