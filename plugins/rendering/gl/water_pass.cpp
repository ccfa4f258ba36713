#include "plugins/rendering/gl/water_pass.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "plugins/rendering/gl/shaders.h"
#include "plugins/rendering/gl/sunlight.h"
#include "plugins/rendering/gl/surface_pass.h"

namespace weir::rendering::gl {
namespace {

const std::string kBackgroundShader = kShaderVersion + kCameraSnippet + kTexelSnippet + R"(
uniform sampler2D uDepth;
uniform ivec2 uSize;  // of the map
out float oDistance;

void main() {
  float depth = texelFetch(uDepth, texelUnder(ivec2(gl_FragCoord.xy), uSize, textureSize(uDepth, 0)), 0).r;
  oDistance = depth < 1.0 ? distanceAt(depth) : 1e30;
}
)";

const std::string kResolveShader = kShaderVersion + R"(
uniform sampler2D uLight;
uniform int uSamples;
out vec4 oLight;

void main() {
  ivec2 first = ivec2(gl_FragCoord.xy) * uSamples;
  vec4 sum = vec4(0.0);
  for (int y = 0; y < uSamples; ++y)
    for (int x = 0; x < uSamples; ++x) sum += texelFetch(uLight, first + ivec2(x, y), 0);
  oLight = sum / float(uSamples * uSamples);
}
)";

const std::string kShadingShader = kCameraSnippet + kLightSnippet + kEnvironmentSnippet + R"(
uniform sampler2D uNearness, uNormal, uThickness, uScene, uDepth, uWaterSamples;
uniform int uSamples;
uniform bool uUnlit;
uniform vec3 uAbsorption, uScattered;
uniform float uScattering, uFoamOpacity, uRefractiveIndex;
out vec4 oLight;

vec3 pointAt(ivec2 place, float nearness) { return rayAt(vec2(place) + 0.5) / abs(nearness); }

// The difference to the neighbours, above all to that which is less far away.
vec3 slope(ivec2 place, ivec2 across, vec3 here) {
  float before = texelFetch(uNearness, place - across, 0).r, behind = texelFetch(uNearness, place + across, 0).r;
  vec3 a = here - pointAt(place - across, before), b = pointAt(place + across, behind) - here;
  if (before == 0.0) return behind == 0.0 ? vec3(across, 0.0) : b;
  if (behind == 0.0) return a;
  float step = here.z * uPixel.y * uTangent.y;
  vec2 weights = 1.0 / (vec2(a.z * a.z, b.z * b.z) + step * step);
  return (a * weights.x + b * weights.y) / (weights.x + weights.y);
}

vec3 normalOf(ivec2 place, float nearness, vec3 here) {
  if (nearness < 0.0) {
    ivec2 first = place * uSamples;
    vec3 sum = vec3(0.0);
    for (int y = 0; y < uSamples; ++y)
      for (int x = 0; x < uSamples; ++x) {
        vec4 normal = texelFetch(uNormal, first + ivec2(x, y), 0);
        sum += normal.a * (normal.xyz * 2.0 - 1.0);
      }
    return normalize(sum);
  }
  vec3 normal = normalize(cross(slope(place, ivec2(1, 0), here), slope(place, ivec2(0, 1), here)));
  return dot(normal, here) > 0.0 ? -normal : normal;
}

float opaqueDistance(ivec2 place) { return distanceAt(texelFetch(uDepth, place, 0).r); }

vec2 windowOf(vec3 position) { return 0.5 + 0.5 * position.xy / (-position.z * uTangent); }

void main() {
  ivec2 place = ivec2(gl_FragCoord.xy);
  float nearness = texelFetch(uNearness, place, 0).r;
  if (nearness == 0.0) discard;
  vec2 window = gl_FragCoord.xy * uPixel * 0.5;
  vec3 position = pointAt(place, nearness);
  vec3 towardsEye = -normalize(position);
  vec3 normal = normalOf(place, nearness, position);

  float gap = max(opaqueDistance(place * uSamples + uSamples / 2) + position.z, 0.0) * length(position) / -position.z;
  vec2 thickness = max(texture(uThickness, window).rg, 0.0);
  float way = min(thickness.x, gap);
  vec3 bent = refract(-towardsEye, normal, 1.0 / uRefractiveIndex);
  vec2 seen = windowOf(position + bent * way);
  ivec2 samples = textureSize(uDepth, 0);
  ivec2 seenSample = clamp(ivec2(seen * vec2(samples)), ivec2(0), samples - 1);
  if (opaqueDistance(seenSample) < -position.z || seen != clamp(seen, 0.0, 1.0)) seen = window;
  vec4 scene = texture(uScene, seen);
  vec3 behind = scene.rgb;

  vec3 extinction = uAbsorption + uScattering;
  vec3 through = exp(-extinction * way);
  vec3 sun = sunlight(position, normal, 1.0, false);
  vec3 inside = skyLight(uUp) + 0.6 * uSunColor * sun;
  vec3 scattered = uScattered * uScattering / max(extinction, 1e-6) * (1.0 - through) * inside;
  vec3 refracted = behind * through + scattered;
  float straight = (uRefractiveIndex - 1.0) / (uRefractiveIndex + 1.0);
  float mirror = fresnel(dot(normal, towardsEye), straight * straight);
  vec3 mirrored = environment(reflect(-towardsEye, normal));
  vec3 color = mix(refracted, mirrored, mirror) + 0.03 * uSunColor * sun * highlight(normal, towardsEye, 400.0);
  float foam = 1.0 - exp(-uFoamOpacity * thickness.y);
  vec3 white = 0.93 * (skyLight(normal) + uSunColor * sun * max(dot(normal, uSun), 0.0));
  if (uUnlit) color = behind * through, white = vec3(1.0);
  float clear = dot(through, vec3(1.0 / 3.0)) * (1.0 - mirror);
  float covered = 1.0 - (1.0 - scene.a) * clear;
  oLight = vec4(mix(color, white, foam), mix(covered, 1.0, foam));
}
)";

const std::string kComposeShader = kShaderVersion + R"(
uniform sampler2D uShaded, uDepth;
uniform int uSamples;
out vec4 oLight;

void main() {
  float depth = texelFetch(uDepth, ivec2(gl_FragCoord.xy), 0).r;
  if (depth >= 1.0) discard;
  oLight = texelFetch(uShaded, ivec2(gl_FragCoord.xy) / uSamples, 0);
  gl_FragDepth = depth;
}
)";

/// The distance of a liquid's middle from the eye.
float distanceOf(const View& view, const MeshStore& meshes, std::size_t water) {
  Aabb box;
  for (const ParticleView& particles : view.particles)
    if (isWater(particles, water))
      for (const Vec3f& p : particles.positions)
        if (isFinite(p)) box.extend(p);
  for (const SurfaceView& surface : view.surfaces)
    if (surface.look == SurfaceLook::kWater && surface.water == water)
      box.extend(placedBounds(meshes.bounds(surface.mesh), surface));
  return box.empty() ? 0 : length(box.center() - view.camera.eye);
}

std::vector<std::size_t> farthestFirst(const View& view, const MeshStore& meshes) {
  std::vector<std::size_t> order(view.waters.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  if (order.size() < 2) return order;
  std::vector<float> distances;
  for (const std::size_t water : order) distances.push_back(distanceOf(view, meshes, water));
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return distances[a] > distances[b]; });
  return order;
}

}  // namespace

WaterPass::WaterPass(const Functions& gl)
    : gl_(gl),
      smoothing_(gl),
      background_(gl, "background of a liquid", kFullScreenVertexShader, kBackgroundShader),
      resolve_(gl, "scene behind a liquid", kFullScreenVertexShader, kResolveShader),
      compose_(gl, "liquid in the scene", kFullScreenVertexShader, kComposeShader),
      array_(makeVertexArray(gl)) {}

const Program& WaterPass::shadingFor(const Frame& frame) {
  const std::string defines = sunlightDefines(frame);
  const auto known = shading_.find(defines);
  if (known != shading_.end()) return known->second;
  const std::string source = kShaderVersion + defines + sunlightSnippet() + kShadingShader;
  return shading_.emplace(defines, Program(gl_, "liquid", kFullScreenVertexShader, source)).first->second;
}

void WaterPass::draw(const Frame& frame, const Targets& targets, const Parts& parts,
                     const std::function<void(const Texture& depth)>& drawBehind) {
  if (frame.view.waters.empty()) return;
  if (!water_ || width_ != targets.pictureWidth || height_ != targets.pictureHeight ||
      samples_ != targets.samples) {
    water_.reset();
    water_.emplace(gl_, targets);
    width_ = targets.pictureWidth, height_ = targets.pictureHeight, samples_ = targets.samples;
  }
  for (const std::size_t water : farthestFirst(frame.view, parts.meshes))
    drawOne(frame, targets, parts, water, drawBehind);
}

void WaterPass::drawOne(const Frame& frame, const Targets& targets, const Parts& parts, std::size_t water,
                        const std::function<void(const Texture& depth)>& drawBehind) {
  const WaterView& view = frame.view.waters[water];
  drawMaps(frame, targets, parts, water);
  smoothing_.smoothSurface(frame, *water_, view.smoothing);
  smoothing_.smoothThickness(frame, *water_, 0.5f * view.smoothing);
  drawBehind(water_->depth);
  resolveScene(frame, targets);
  shade(frame, targets, parts, view);
  compose(frame, targets);
}

/// Depth, normals and thickness of the liquid.
void WaterPass::drawMaps(const Frame& frame, const Targets& targets, const Parts& parts,
                         std::size_t water) const {
  constexpr std::array<float, 4> kNothing{0, 0, 0, 0};
  constexpr float kFarthest = 1;
  gl_.bindFramebuffer(GL_FRAMEBUFFER, water_->surface.name());
  gl_.viewport(0, 0, frame.width, frame.height);
  gl_.enable(GL_DEPTH_TEST);
  gl_.depthFunc(GL_LEQUAL);
  gl_.depthMask(GL_TRUE);
  gl_.clearBufferfv(GL_COLOR, 0, kNothing.data());
  gl_.clearBufferfv(GL_DEPTH, 0, &kFarthest);
  parts.particles.drawDepth(frame, water, water_->depth);
  parts.surfaces.drawDepth(frame, water, parts.meshes, {frame.width, frame.height});

  gl_.disable(GL_DEPTH_TEST);
  gl_.viewport(0, 0, water_->thicknessWidth, water_->thicknessHeight);
  drawBackground(frame, targets);
  gl_.bindFramebuffer(GL_FRAMEBUFFER, water_->thicknessTargets[0].name());
  gl_.clearBufferfv(GL_COLOR, 0, kNothing.data());
  parts.particles.drawThickness(frame, water, water_->depth, {water_->background, water_->backgroundTarget},
                                {water_->thickness[0], water_->thicknessWidth, water_->thicknessHeight});
  gl_.bindFramebuffer(GL_FRAMEBUFFER, water_->thicknessTargets[0].name());
  parts.surfaces.drawThickness(frame, water, parts.meshes, {water_->thicknessWidth, water_->thicknessHeight});
}

void WaterPass::drawBackground(const Frame& frame, const Targets& targets) const {
  gl_.bindFramebuffer(GL_FRAMEBUFFER, water_->backgroundTarget.name());
  gl_.bindVertexArray(array_.name());
  background_.use();
  setCameraUniforms(background_, frame.camera, frame.width, frame.height);
  background_.setTexture("uDepth", 0, targets.depth);
  background_.set("uSize", Vec2i{water_->thicknessWidth, water_->thicknessHeight});
  gl_.drawArrays(GL_TRIANGLES, 0, 3);
}

void WaterPass::resolveScene(const Frame& frame, const Targets& targets) const {
  gl_.disable(GL_DEPTH_TEST);
  gl_.viewport(0, 0, targets.pictureWidth, targets.pictureHeight);
  gl_.bindFramebuffer(GL_FRAMEBUFFER, water_->sceneTarget.name());
  gl_.bindVertexArray(array_.name());
  resolve_.use();
  resolve_.setTexture("uLight", 0, targets.light);
  resolve_.set("uSamples", frame.samples);
  gl_.drawArrays(GL_TRIANGLES, 0, 3);
}

void WaterPass::shade(const Frame& frame, const Targets& targets, const Parts& parts, const WaterView& view) {
  const Program& program = shadingFor(frame);
  gl_.bindFramebuffer(GL_FRAMEBUFFER, water_->shadedTarget.name());
  program.use();
  setCameraUniforms(program, frame.camera, targets.pictureWidth, targets.pictureHeight);
  setLightUniforms(program, frame);
  program.setTexture("uNearness", 0, water_->nearness[1]);
  program.setTexture("uNormal", 1, water_->normal);
  program.setTexture("uThickness", 2, water_->thickness[0]);
  program.setTexture("uScene", 3, water_->scene);
  program.setTexture("uDepth", 4, targets.depth);
  setSunlightUniforms(program, frame, parts.shadows, &parts.waterShadows, 5);
  parts.environment.setUniforms(program, frame, 9);
  program.set("uSamples", frame.samples);
  program.set("uUnlit", int(frame.view.lighting.unlit));
  program.set("uAbsorption", view.absorption);
  program.set("uScattered", linear(view.scattered));
  program.set("uScattering", view.scattering);
  program.set("uFoamOpacity", view.foamOpacity);
  program.set("uRefractiveIndex", view.refractiveIndex);
  gl_.drawArrays(GL_TRIANGLES, 0, 3);
}

void WaterPass::compose(const Frame& frame, const Targets& targets) const {
  gl_.bindFramebuffer(GL_FRAMEBUFFER, targets.lightWithDepth.name());
  gl_.viewport(0, 0, frame.width, frame.height);
  gl_.enable(GL_DEPTH_TEST);
  gl_.depthFunc(GL_LESS);
  compose_.use();
  compose_.setTexture("uShaded", 0, water_->shaded);
  compose_.setTexture("uDepth", 1, water_->depth);
  compose_.set("uSamples", frame.samples);
  gl_.drawArrays(GL_TRIANGLES, 0, 3);
  gl_.depthFunc(GL_LEQUAL);
}

}  // namespace weir::rendering::gl
