#include "plugins/rendering/gl/particle_pass.h"

#include <algorithm>
#include <cmath>

#include "framework/base/check.h"
#include "plugins/rendering/gl/particle_colors.h"
#include "plugins/rendering/gl/sphere_shaders.h"

namespace weir::rendering::gl {
namespace {

const std::string kGeometryFragmentShader =
    kShaderVersion + kCameraSnippet + kNormalSnippet + kMaterialSnippet + kSphereHitSnippet + R"(
flat in vec3 vColor;
layout(location = 0) out vec4 oAlbedo;
layout(location = 1) out vec2 oNormal;

void main() {
  vec3 ray = rayAt(gl_FragCoord.xy);
  float distance = distanceOfSphere(ray);
  vec3 normal = (ray * distance - vCenter) / uRadius;
  gl_FragDepth = depthAt(distance);
  oAlbedo = vec4(vColor, kParticle);
  oNormal = storedNormal(normal);
}
)";

/// Texture coordinate of a place among the texels of the colours.
float placeOf(float entry) {
  return (entry + 0.5f) / float(ParticleColors::kCount);
}

}  // namespace

ParticlePass::ParticlePass(const Functions& gl)
    : gl_(gl),
      geometry_(gl, "particles", kSphereVertexShader, kGeometryFragmentShader),
      shadow_(gl, "shadows of particles", kSunSphereVertexShader, kSunSphereFragmentShader),
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
  for (const ParticleView& view : views)
    if (!view.water) box.extend(loadOne(view));
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
