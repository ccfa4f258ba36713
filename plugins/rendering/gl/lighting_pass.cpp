#include "plugins/rendering/gl/lighting_pass.h"

#include <algorithm>

#include "plugins/rendering/gl/shaders.h"
#include "plugins/rendering/gl/sunlight.h"

namespace weir::rendering::gl {
namespace {

const std::string kLightingShader =
    kCameraSnippet + kNormalSnippet + kMaterialSnippet + kLightSnippet + kEnvironmentSnippet + R"(
uniform sampler2D uAlbedo, uNormal, uDepth, uOcclusion;
uniform vec3 uBackgroundTop, uBackgroundBottom;
uniform vec3 uGroundMiddle;   // in camera space
uniform float uGroundRadius;
uniform float uTiles;         // side of the ground's tiles, m
uniform mat3 uToWorld;        // from camera space to one in which y is up
uniform bool uUnlit, uTransparent;
out vec4 oLight;

#ifdef TILES
// How light the ground's tiles are, and the joints between them, which are as wide as a sample at least, and paler
// where they would be narrower. Where a sample and its neighbours lie follows from its ray alone: differences
// between fragments (fwidth) are of squares of two that drivers take as they like, and mean nothing at outlines.
float tiles(vec3 ray) {
  float falling = min(dot(ray, uUp), -1e-6);
  float away = dot(uGroundMiddle, uUp) / falling;
  vec2 place = (uToWorld * (ray * away - uGroundMiddle)).xz / uTiles;
  vec3 right = vec3(1.0, 0.0, 0.0) - ray * (uUp.x / falling), up = vec3(0.0, 1.0, 0.0) - ray * (uUp.y / falling);
  vec2 fine = uPixel * uTangent * (away / uTiles);
  fine = max(fine.x * abs((uToWorld * right).xz) + fine.y * abs((uToWorld * up).xz), 1e-6);  // a sample, in tiles
  vec2 width = max(vec2(0.012), fine);
  vec2 aside = abs(fract(place - 0.5) - 0.5);
  vec2 joint = (1.0 - smoothstep(width * 0.5, width * 0.5 + fine, aside)) * min(vec2(1.0), vec2(0.012) / fine);
  vec2 tile = floor(place);
  return mix(1.0, 0.86, mod(tile.x + tile.y, 2.0)) * (1.0 - 0.35 * max(joint.x, joint.y));
}
#endif

vec3 backgroundAt(float height) { return mix(uBackgroundBottom, uBackgroundTop, smoothstep(0.0, 1.0, height)); }

void main() {
  ivec2 place = ivec2(gl_FragCoord.xy);
  vec2 window = gl_FragCoord.xy * uPixel * 0.5;
  vec3 ray = rayAt(gl_FragCoord.xy);
  float depth = texelFetch(uDepth, place, 0).r;
  vec4 surface = texelFetch(uAlbedo, place, 0);
  vec3 position = ray * distanceAt(depth);
  bool nothing = depth >= 1.0, ground = isMaterial(surface.a, kGround), particle = isMaterial(surface.a, kParticle);

  // Much of a picture is nothing but background, and little of the ground fades into it.
  float faded = nothing ? 1.0 : ground ? smoothstep(0.12, 0.9, length(position - uGroundMiddle) / uGroundRadius) : 0.0;
  vec3 background = vec3(0.0);
  if (faded > 0.0) {
#ifdef OUTSIDE
    background = environment(normalize(ray));
#else
    background = backgroundAt(window.y);
#endif
    if (faded >= 1.0) {
      oLight = uTransparent ? vec4(0.0) : vec4(background, 1.0);
      return;
    }
  }

  vec3 normal = normalOf(texelFetch(uNormal, place, 0).rg);
  vec3 towardsEye = -normalize(position);
#ifdef TILES
  if (ground) surface.rgb *= tiles(ray);
#endif
  float open = textureLod(uOcclusion, window, 0.0).r;
  float facing = dot(normal, uSun);
  vec3 sun = vec3(0.0);
  if (facing >= 0.0) sun = sunlight(position, normal, particle ? 0.5 : 1.0, true);
  vec3 diffuse = skyLight(normal) * open + uSunColor * sun * max(facing, 0.0) * mix(1.0, open, 0.35);
  vec3 color = surface.rgb * diffuse;
  float rim = fresnel(dot(normal, towardsEye), 0.04);
  if (particle) color += 0.10 * uSunColor * sun * highlight(normal, towardsEye, 40.0) * step(0.0, facing) * 0.25 +
                         0.25 * rim * open * uSkyColor * surface.rgb;
#ifdef METAL
  if (isMaterial(surface.a, kMetal)) {
#ifdef MIRRORS
    vec3 mirrored = environment(reflect(-towardsEye, normal));
#else
    vec3 mirrored = reflectedLight(reflect(-towardsEye, normal), 1.0);
#endif
    vec3 tint = mix(surface.rgb, vec3(1.0), fresnel(dot(normal, towardsEye), 0.0));
    color = 0.25 * color + tint * (0.85 * mirrored * mix(0.4, 1.0, open) +
                                   0.12 * sun * highlight(normal, towardsEye, 120.0) * step(0.0, facing));
  }
#endif
  if (uUnlit) color = surface.rgb;
  if (ground) color = mix(color, background, faded);
  oLight = vec4(color, 1.0);
  if (!uTransparent || !ground) return;
  // Of the ground, what it lacks of the light that it would have without the scene.
  vec3 lit = skyLight(normal) + uSunColor * max(facing, 0.0);
  float dark = clamp(1.0 - dot(diffuse, vec3(1.0)) / max(dot(lit, vec3(1.0)), 1e-6), 0.0, 1.0);
  oLight = vec4(vec3(0.0), uUnlit ? 0.0 : dark * (1.0 - faded));
}
)";

const std::string kResolveShader = kShaderVersion + R"(
uniform sampler2D uLight;
uniform int uSamples, uHeight;
uniform bool uUnlit, uFilmic;
uniform float uExposure;
out vec4 oColor;  // not multiplied with its opacity

// Leaves light below the knee alone, and bends what is above it towards 1.
vec3 shoulder(vec3 light) {
  const float kKnee = 0.8;
  if (max(light.r, max(light.g, light.b)) <= kKnee) return light;
  vec3 over = max(light - kKnee, 0.0) / (1.0 - kKnee);
  return min(light, kKnee) + (1.0 - kKnee) * (1.0 - exp(-over));
}

// The curve that K. Narkowicz (2015) fitted to the film tones of ACES.
vec3 filmic(vec3 light) {
  return clamp(light * (2.51 * light + 0.03) / (light * (2.43 * light + 0.59) + 0.14), 0.0, 1.0);
}

vec3 toned(vec3 light) {
  if (uUnlit) return min(light, 1.0);
  light *= uExposure;
  return uFilmic ? filmic(0.8 * light) : shoulder(light);
}

vec3 encoded(vec3 light) {
  return mix(12.92 * light, 1.055 * pow(light, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, light));
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.x, uHeight - 1 - int(gl_FragCoord.y));
  vec4 sum = vec4(0.0);
  for (int y = 0; y < uSamples; ++y)
    for (int x = 0; x < uSamples; ++x) {
      vec4 light = texelFetch(uLight, pixel * uSamples + ivec2(x, y), 0);
      vec3 color = toned(light.rgb);
      // Light that clear things add must be seen on any background.
      sum += vec4(color, max(light.a, max(color.r, max(color.g, color.b))));
    }
  sum.a = min(sum.a, float(uSamples * uSamples));
  oColor = vec4(encoded(sum.rgb / max(sum.a, 1e-6)), sum.a / float(uSamples * uSamples));
}
)";

}  // namespace

LightingPass::LightingPass(const Functions& gl)
    : gl_(gl),
      resolve_(gl, "resolve", kFullScreenVertexShader, kResolveShader),
      array_(makeVertexArray(gl)) {}

const Program& LightingPass::programFor(const Frame& frame) {
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
  const std::string source = kShaderVersion + defines + sunlightSnippet() + kLightingShader;
  return lighting_.emplace(defines, Program(gl_, "lighting", kFullScreenVertexShader, source)).first->second;
}

void LightingPass::draw(const Frame& frame, const Targets& targets, const ShadowPass& shadows,
                        const WaterShadow* water, const Environment& environment) {
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
  setSunlightUniforms(lighting, frame, shadows, water, 4);
  environment.setUniforms(lighting, frame, 8);
  lighting.set("uBackgroundTop", linear(view.backgroundTop));
  lighting.set("uBackgroundBottom", linear(view.backgroundBottom));
  const Vec3f up = normalized(view.worldUp);
  const GroundView& ground = view.ground;
  lighting.set("uGroundMiddle",
               frame.camera.point(ground.center + up * (ground.height - dot(ground.center, up))));
  lighting.set("uGroundRadius", ground.radius);
  lighting.set("uTiles", ground.tiles);
  lighting.setMatrix3("uToWorld", environment.fromCamera(frame).eval().data());
  lighting.set("uUnlit", int(view.lighting.unlit));
  lighting.set("uTransparent", int(view.transparent));
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
  resolve_.set("uFilmic", int(frame.view.lighting.tone == ToneCurve::kFilmic));
  resolve_.set("uExposure", frame.view.lighting.exposure);
  resolve_.set("uUnlit", int(frame.view.lighting.unlit));
  gl_.drawArrays(GL_TRIANGLES, 0, 3);
}

}  // namespace weir::rendering::gl
