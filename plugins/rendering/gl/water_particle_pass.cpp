#include "plugins/rendering/gl/water_particle_pass.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "framework/base/check.h"
#include "plugins/rendering/gl/sphere_shaders.h"

namespace weir::rendering::gl {
namespace {

const std::string kDepthFragmentShader = kShaderVersion + kCameraSnippet + kSphereHitSnippet + R"(
uniform float uInset;  // m
layout(location = 0) out vec4 oNormal;

void main() {
  gl_FragDepth = depthAt(distanceOfSphere(rayAt(gl_FragCoord.xy)) + uInset);
  oNormal = vec4(0.0);  // is found later
}
)";

const std::string kThicknessVertexShader = kShaderVersion + kCornerSnippet + R"(
uniform mat4 uToClip;
uniform vec2 uSize;           // of the map, in texels
uniform float uRadius, uNear; // m
uniform float uTexels;        // of 1 m at a distance of 1 m
flat out vec4 vSphere;        // middle and radius in texels, distance in m, part of foam
flat out float vAlong;

void main() {
  vec4 data = particle();
  vec4 clip = uToClip * vec4(data.xyz, 1.0);
  float radius = uRadius * uTexels / clip.w;
  float drawn = max(radius, 1.0);
  vec2 middle = (0.5 + 0.5 * clip.xy / clip.w) * uSize;
  vSphere = vec4(middle, radius, data.w);
  vAlong = clip.w;
  vec2 place = (middle + drawn * (2.0 * corner() - 1.0)) / uSize * 2.0 - 1.0;
  gl_Position = clip.w < uNear ? vec4(0.0, 0.0, 2.0, 1.0) : vec4(place, 0.0, 1.0);
}
)";

const std::string kThicknessFragmentShader = kShaderVersion + kCameraSnippet + kTexelSnippet + R"(
uniform float uRadius;
uniform float uVolumeOfSphere;
uniform float uFoamDepth;     // m; 0 for the sun
uniform sampler2D uFront, uBackground;
flat in vec4 vSphere;
flat in float vAlong;
layout(location = 0) out vec2 oThickness;

void main() {
  float drawn = max(vSphere.z, 1.0);
  vec2 aside = (gl_FragCoord.xy - vSphere.xy) / drawn;
  float rest = 1.0 - dot(aside, aside);
  if (rest < 0.0) discard;
  float spread = vSphere.z / drawn;
  float chord = 2.0 * uRadius * sqrt(rest) * spread * spread * uVolumeOfSphere;
  float foam = vSphere.w;
  if (uFoamDepth > 0.0) {
    ivec2 place = ivec2(gl_FragCoord.xy);
    if (vAlong > texelFetch(uBackground, place, 0).r) discard;
    ivec2 under = texelUnder(place, textureSize(uBackground, 0), textureSize(uFront, 0));
    float front = distanceAt(texelFetch(uFront, under, 0).r);
    foam *= clamp(1.0 - (vAlong - front) / uFoamDepth, 0.0, 1.0);
  }
  oThickness = vec2(chord, chord * foam);
}
)";

}  // namespace

float insetOf(const ParticleView& particles) {
  return std::max(0.0f, particles.radius - 0.5f * std::cbrt(particles.volume));
}

float volumeOfSphere(const ParticleView& particles) {
  const float r = particles.radius;
  const float sphere = 4 * std::numbers::pi_v<float> / 3 * r * r * r;
  return particles.volume > 0 ? particles.volume / sphere : 1.0f;
}

WaterParticlePass::WaterParticlePass(const Functions& gl)
    : gl_(gl),
      depth_(gl, "depth of a liquid", kSphereVertexShader, kDepthFragmentShader),
      sunDepth_(gl, "depth of a liquid from the sun", kSunSphereVertexShader, kSunSphereFragmentShader),
      thickness_(gl, "thickness of a liquid", kThicknessVertexShader, kThicknessFragmentShader),
      array_(makeVertexArray(gl)),
      indices_(makeBuffer(gl)),
      nothing_(makeTexture(gl, 1, 1, kFloat1, GL_NEAREST)) {
  GLint texels = 0;
  gl.getIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &texels);
  constexpr int kBatch = 1 << 17;
  largestBatch_ = std::min(kBatch, int(texels));
  gl.bindVertexArray(array_.name());
  const std::vector<std::uint32_t> indices = cornerIndices(largestBatch_);
  upload(indices_, GL_ELEMENT_ARRAY_BUFFER, std::as_bytes(std::span(indices)), GL_STATIC_DRAW);
  GLuint name = 0;
  gl.genTextures(1, &name);
  centers_ = Texture(gl, name);
}

Aabb WaterParticlePass::load(std::span<const ParticleView> views) {
  batches_.clear();
  Aabb box;
  for (const ParticleView& view : views)
    if (view.water) box.extend(loadOne(view));
  return box;
}

Aabb WaterParticlePass::loadOne(const ParticleView& particles) {
  const bool foams = !particles.foam.empty();
  if (foams) WEIR_CHECK(particles.foam.size() == particles.positions.size());
  packed_.clear();
  Aabb box;
  for (std::size_t i = 0; i < particles.positions.size(); ++i) {
    const Vec3f& p = particles.positions[i];
    if (!isFinite(p)) continue;
    box.extend(p);
    packed_.push_back({p.x, p.y, p.z, foams ? particles.foam[i] : 0.0f});
  }
  for (std::size_t first = 0; first < packed_.size(); first += std::size_t(largestBatch_)) {
    const auto part =
        std::span(packed_).subspan(first).first(std::min(packed_.size() - first, std::size_t(largestBatch_)));
    batches_.push_back({makeBuffer(gl_), GLsizei(part.size()), *particles.water, particles.radius,
                        volumeOfSphere(particles), insetOf(particles)});
    upload(batches_.back().centers, GL_TEXTURE_BUFFER, std::as_bytes(part), GL_STREAM_DRAW);
  }
  if (packed_.empty()) return box;
  const Vec3f around{particles.radius, particles.radius, particles.radius};
  return {box.lo - around, box.hi + around};
}

template <class SetUniforms>
void WaterParticlePass::draw(const Program& program, std::size_t water, SetUniforms setUniforms) const {
  program.use();
  gl_.bindVertexArray(array_.name());
  program.setTexture("uCenters", 0, centers_, GL_TEXTURE_BUFFER);
  for (const Batch& batch : batches_) {
    if (batch.water != water) continue;
    program.set("uRadius", batch.radius);
    setUniforms(batch);
    gl_.activeTexture(GL_TEXTURE0);
    gl_.texBuffer(GL_TEXTURE_BUFFER, GL_RGBA32F, batch.centers.name());
    gl_.drawElements(GL_TRIANGLES, 6 * batch.particles, GL_UNSIGNED_INT, nullptr);
  }
}

template <class SetUniforms>
void WaterParticlePass::addThickness(std::size_t water, const ThicknessMap& map,
                                     SetUniforms setUniforms) const {
  gl_.enable(GL_BLEND);
  gl_.blendFunc(GL_ONE, GL_ONE);
  draw(thickness_, water, [&](const Batch& batch) {
    thickness_.set("uSize", Vec2f{float(map.width), float(map.height)});
    thickness_.set("uVolumeOfSphere", batch.volumeOfSphere);
    setUniforms(batch);
  });
  gl_.disable(GL_BLEND);
  gl_.blendFunc(GL_ONE, GL_ZERO);
}

void WaterParticlePass::drawDepth(const Frame& frame, std::size_t water, const Texture&) {
  draw(depth_, water, [&](const Batch& batch) {
    depth_.set("uInset", batch.inset);
    setCameraUniforms(depth_, frame.camera, frame.width, frame.height);
    depth_.setMatrix4("uView", frame.camera.view.data());
    depth_.set("uNear", frame.camera.near);
  });
}

void WaterParticlePass::drawThickness(const Frame& frame, std::size_t water, const Texture& front,
                                      const LiquidBackground& background, const ThicknessMap& map) {
  const Eigen::Matrix4f toClip = frame.camera.projection() * frame.camera.view;
  addThickness(water, map, [&](const Batch& batch) {
    setCameraUniforms(thickness_, frame.camera, map.width, map.height);
    thickness_.setMatrix4("uToClip", toClip.data());
    thickness_.set("uTexels", 0.5f * float(map.height) / frame.camera.tangent.y);
    thickness_.set("uNear", frame.camera.near);
    thickness_.set("uFoamDepth", kFoamDepth * batch.radius);
    thickness_.setTexture("uFront", 1, front);
    thickness_.setTexture("uBackground", 2, background.distance);
  });
}

void WaterParticlePass::drawSunDepth(const SunView& sun, std::size_t water, const Texture&, int) {
  draw(sunDepth_, water, [&](const Batch& batch) {
    sunDepth_.setMatrix4("uToClip", sun.toClip().eval().data());
    sunDepth_.set("uHalfSize", sun.halfSize);
    sunDepth_.set("uRadiusInDepth", 2 * batch.radius / (sun.zNearest - sun.zFarthest));
  });
}

void WaterParticlePass::drawSunThickness(const SunView& sun, std::size_t water, const ThicknessMap& map) {
  addThickness(water, map, [&](const Batch&) {
    thickness_.setMatrix4("uToClip", sun.toClip().eval().data());
    thickness_.set("uTexels", 0.5f * float(map.height) / sun.halfSize);
    thickness_.set("uNear", 0.0f);
    thickness_.set("uFoamDepth", 0.0f);
    thickness_.setTexture("uFront", 1, nothing_);
    thickness_.setTexture("uBackground", 2, nothing_);
  });
}

}  // namespace weir::rendering::gl
