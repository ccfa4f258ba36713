#include "plugins/rendering/gl/particle_pass.h"

#include <algorithm>
#include <cmath>

#include "framework/base/check.h"
#include "plugins/rendering/gl/particle_colors.h"
#include "plugins/rendering/gl/shaders.h"

namespace weir::rendering::gl {
namespace {

// Vertex 4i + k is corner k of particle i; the indices make two triangles of the four corners.
const std::string kCornerSnippet = R"(
uniform samplerBuffer uCenters;
vec4 particle() { return texelFetch(uCenters, gl_VertexID >> 2); }
vec2 corner() { return vec2(gl_VertexID & 1, (gl_VertexID >> 1) & 1); }
)";

// The rectangle around a sphere's picture: per axis, the two lines through the eye that touch the sphere's
// circle in the plane of that axis and the viewing axis (M. Mara, M. McGuire 2013).
const std::string kGeometryVertexShader = kShaderVersion + kCornerSnippet + R"(
uniform mat4 uView;
uniform vec2 uTangent;
uniform float uRadius, uNear;
uniform sampler2D uColors;
flat out vec3 vCenter;
flat out vec3 vColor;

vec2 touchingLines(float across, float along) {
  float touch = sqrt(across * across + along * along - uRadius * uRadius);
  return vec2((across * touch - along * uRadius) / (along * touch + across * uRadius),
              (across * touch + along * uRadius) / (along * touch - across * uRadius));
}

void main() {
  vec4 data = particle();
  vCenter = (uView * vec4(data.xyz, 1.0)).xyz;
  vColor = textureLod(uColors, vec2(data.w, 0.5), 0.0).rgb;
  float along = -vCenter.z;
  if (along + uRadius < uNear) {  // behind the camera
    gl_Position = vec4(0.0, 0.0, 2.0, 1.0);
    return;
  }
  vec2 low = vec2(-1.0), high = vec2(1.0);
  if (along - uRadius > uNear) {  // otherwise it may fill the picture
    vec2 x = touchingLines(vCenter.x, along) / uTangent.x;
    vec2 y = touchingLines(vCenter.y, along) / uTangent.y;
    low = vec2(x.x, y.x);
    high = vec2(x.y, y.y);
  }
  gl_Position = vec4(mix(low, high, corner()), 0.0, 1.0);
}
)";

const std::string kGeometryFragmentShader = kShaderVersion + kCameraSnippet + kMaterialSnippet + R"(
uniform float uRadius, uNear;
flat in vec3 vCenter;
flat in vec3 vColor;
layout(location = 0) out vec4 oAlbedo;
layout(location = 1) out vec4 oNormal;

void main() {
  vec3 ray = rayAt(gl_FragCoord.xy);
  // From the point of the ray that is nearest to the centre: exact also for small spheres far away.
  float scale = 1.0 / dot(ray, ray);
  float middle = dot(ray, vCenter) * scale;
  vec3 aside = ray * middle - vCenter;
  float rest = uRadius * uRadius - dot(aside, aside);
  float distance = middle - sqrt(max(rest, 0.0) * scale);
  if (rest < 0.0 || distance < uNear) discard;
  vec3 normal = (ray * distance - vCenter) / uRadius;
  gl_FragDepth = depthAt(distance);
  oAlbedo = vec4(vColor, kParticle);
  oNormal = vec4(0.5 + 0.5 * normal, 1.0);
}
)";

const std::string kShadowVertexShader = kShaderVersion + kCornerSnippet + R"(
uniform mat4 uToClip;
uniform float uHalfSize, uRadius;
flat out float vDepth;
out vec2 vPlace;

void main() {
  vec4 center = uToClip * vec4(particle().xyz, 1.0);
  vPlace = 2.0 * corner() - 1.0;
  vDepth = center.z;
  gl_Position = vec4(center.xy + vPlace * (uRadius / uHalfSize), center.z, 1.0);
}
)";

const std::string kShadowFragmentShader = kShaderVersion + R"(
uniform float uRadiusInDepth;
flat in float vDepth;
in vec2 vPlace;

void main() {
  float rest = 1.0 - dot(vPlace, vPlace);
  if (rest < 0.0) discard;
  gl_FragDepth = 0.5 + 0.5 * (vDepth - uRadiusInDepth * sqrt(rest));
}
)";

/// Texture coordinate of a place among the texels of the colours.
float placeOf(float entry) {
  return (entry + 0.5f) / float(ParticleColors::kCount);
}

/// Two triangles for each four corners.
std::vector<std::uint32_t> cornerIndices(int particles) {
  std::vector<std::uint32_t> indices;
  indices.reserve(6 * std::size_t(particles));
  for (std::uint32_t first = 0; first < 4 * std::uint32_t(particles); first += 4)
    for (const std::uint32_t k : {0u, 1u, 2u, 2u, 1u, 3u}) indices.push_back(first + k);
  return indices;
}

}  // namespace

ParticlePass::ParticlePass(const Functions& gl)
    : gl_(gl),
      geometry_(gl, "particles", kGeometryVertexShader, kGeometryFragmentShader),
      shadow_(gl, "shadows of particles", kShadowVertexShader, kShadowFragmentShader),
      array_(makeVertexArray(gl)),
      indices_(makeBuffer(gl)) {
  GLint texels = 0;
  gl.getIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &texels);
  constexpr int kBatch = 1 << 17;  // 3 MB of indices
  largestBatch_ = std::min(kBatch, int(texels));
  gl.bindVertexArray(array_.name());
  const std::vector<std::uint32_t> indices = cornerIndices(largestBatch_);
  upload(indices_, GL_ELEMENT_ARRAY_BUFFER, std::as_bytes(std::span(indices)), GL_STATIC_DRAW);
  GLuint name = 0;
  gl.genTextures(1, &name);
  centers_ = Texture(gl, name);
}

Aabb ParticlePass::load(std::span<const ParticleView> views) {
  batches_.clear();
  colors_.clear();
  Aabb box;
  for (const ParticleView& view : views) box.extend(loadOne(view));
  return box;
}

Aabb ParticlePass::loadOne(const ParticleView& particles) {
  const bool colored = !particles.values.empty();
  if (colored) WEIR_CHECK(particles.values.size() == particles.positions.size());
  const ParticleColors colors(particles);
  packed_.clear();
  packed_.reserve(particles.positions.size());
  Aabb box;
  for (std::size_t i = 0; i < particles.positions.size(); ++i) {
    const Vec3f& p = particles.positions[i];
    if (!isFinite(p)) continue;
    box.extend(p);
    packed_.push_back(
        {p.x, p.y, p.z,
         placeOf(colored ? colors.entryOf(particles.values[i]) : ParticleColors::fixedEntry())});
  }
  if (packed_.empty()) return box;
  colors_.push_back(makeTexture(gl_, ParticleColors::kCount, 1, kColor8, GL_LINEAR, colors.texels().data()));
  for (std::size_t first = 0; first < packed_.size(); first += std::size_t(largestBatch_)) {
    const auto part =
        std::span(packed_).subspan(first).first(std::min(packed_.size() - first, std::size_t(largestBatch_)));
    batches_.push_back({makeBuffer(gl_), GLsizei(part.size()), particles.radius, colors_.size() - 1});
    upload(batches_.back().centers, GL_TEXTURE_BUFFER, std::as_bytes(part), GL_STREAM_DRAW);
  }
  const Vec3f around{particles.radius, particles.radius, particles.radius};
  return {box.lo - around, box.hi + around};
}

template <class SetUniforms>
void ParticlePass::draw(const Program& program, SetUniforms setUniforms) const {
  if (batches_.empty()) return;
  program.use();
  gl_.bindVertexArray(array_.name());
  program.setTexture("uCenters", 0, centers_, GL_TEXTURE_BUFFER);
  for (const Batch& batch : batches_) {
    setUniforms(batch);
    gl_.activeTexture(GL_TEXTURE0);
    gl_.texBuffer(GL_TEXTURE_BUFFER, GL_RGBA32F, batch.centers.name());
    gl_.drawElements(GL_TRIANGLES, 6 * batch.particles, GL_UNSIGNED_INT, nullptr);
  }
}

void ParticlePass::drawGeometry(const Frame& frame, const Targets&) {
  draw(geometry_, [&](const Batch& batch) {
    setCameraUniforms(geometry_, frame.camera, frame.width, frame.height);
    geometry_.setMatrix4("uView", frame.camera.view.data());
    geometry_.set("uNear", frame.camera.near);
    geometry_.set("uRadius", batch.radius);
    geometry_.setTexture("uColors", 1, colors_[batch.colors]);
  });
}

void ParticlePass::drawShadow(const SunView& sun, const Texture&, int) {
  draw(shadow_, [&](const Batch& batch) {
    shadow_.setMatrix4("uToClip", sun.toClip().eval().data());
    shadow_.set("uHalfSize", sun.halfSize);
    shadow_.set("uRadius", batch.radius);
    shadow_.set("uRadiusInDepth", 2 * batch.radius / (sun.zNearest - sun.zFarthest));
  });
}

}  // namespace weir::rendering::gl
