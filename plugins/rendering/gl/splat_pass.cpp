#include "plugins/rendering/gl/splat_pass.h"

#include "framework/base/check.h"
#include "plugins/rendering/gl/particle_colors.h"

namespace weir::rendering::gl {

namespace {

constexpr std::uint32_t kParticleMaterial = 128;  // kParticle of kMaterialSnippet, in eight bits

std::uint32_t packedColor(const std::array<std::uint8_t, 3>& color) {
  return color[0] | std::uint32_t{color[1]} << 8 | std::uint32_t{color[2]} << 16 | kParticleMaterial << 24;
}

void setRows(const Eigen::Matrix4f& matrix, Vec3f (&rows)[3], Vec3f& moved) {
  for (int i = 0; i < 3; ++i) rows[i] = {matrix(i, 0), matrix(i, 1), matrix(i, 2)};
  moved = {matrix(0, 3), matrix(1, 3), matrix(2, 3)};
}

SplatCamera splatCameraOf(const Frame& frame) {
  SplatCamera camera{.tangent = frame.camera.tangent,
                     .projection = frame.camera.projectionTerms(),
                     .near = frame.camera.near,
                     .width = frame.width,
                     .height = frame.height};
  setRows(frame.camera.view, camera.rows, camera.moved);
  return camera;
}

void replace(const Functions& gl, const Texture& texture, int width, int height, const TextureFormat& format,
             const void* texels) {
  gl.bindTexture(GL_TEXTURE_2D, texture.name());
  gl.texSubImage2D(GL_TEXTURE_2D, 0, 0, 0, width, height, format.format, format.type, texels);
}

}  // namespace

SplatPass::SplatPass(const Functions& gl, Device& device)
    : gl_(gl),
      device_(device),
      spheres_(device),
      nearest_(device),
      albedo_(device),
      normal_(device),
      shadow_(device),
      depth_(device),
      albedoCopy_(device),
      normalCopy_(device),
      shadowCopy_(device),
      depthCopy_(device) {}

Aabb SplatPass::load(std::span<const ParticleView> views) {
  packed_.clear();
  Aabb box;
  for (const ParticleView& view : views)
    if (!view.water) box.extend(loadOne(view));
  spheres_.assign(packed_);
  return box;
}

Aabb SplatPass::loadOne(const ParticleView& particles) {
  const bool colored = !particles.values.empty();
  if (colored) WEIR_CHECK(particles.values.size() == particles.positions.size());
  const ParticleColors colors(particles);
  const std::uint32_t fixed = packedColor(colors.at(ParticleColors::fixedEntry()));
  const std::size_t before = packed_.size();
  Aabb box;
  for (std::size_t i = 0; i < particles.positions.size(); ++i) {
    const Vec3f& p = particles.positions[i];
    if (!isFinite(p)) continue;
    box.extend(p);
    packed_.push_back(
        {p, particles.radius, colored ? packedColor(colors.at(colors.entryOf(particles.values[i]))) : fixed});
  }
  if (packed_.size() == before) return box;
  const Vec3f around{particles.radius, particles.radius, particles.radius};
  return {box.lo - around, box.hi + around};
}

template <class T>
const T* SplatPass::onHost(const Array<T>& array, HostCopy<T>& copy) const {
  if (device_.kind() == DeviceKind::kCpu) return array.data();
  copy.resize(array.size());
  copy.start(0, array.data(), array.size());
  return copy.wait().data();
}

void SplatPass::drawGeometry(const Frame& frame, const Targets& targets) {
  const std::int64_t samples = std::int64_t{frame.width} * frame.height;
  nearest_.resizeDiscarding(samples);
  albedo_.resizeDiscarding(samples);
  normal_.resizeDiscarding(samples);
  depth_.resizeDiscarding(samples);
  dispatch(device_, [&](auto& device) {
    splatGeometry(device, spheres_.view(), splatCameraOf(frame), nearest_.view(),
                  {albedo_.view(), normal_.view(), depth_.view()});
  });
  replace(gl_, targets.albedo, frame.width, frame.height, kSrgb8, onHost(albedo_, albedoCopy_));
  replace(gl_, targets.normal, frame.width, frame.height, kColor10, onHost(normal_, normalCopy_));
  replace(gl_, targets.depth, frame.width, frame.height, kDepth32F, onHost(depth_, depthCopy_));
}

void SplatPass::drawShadow(const SunView& sun, const Texture& map, int resolution) {
  SplatSun view{
      .halfSize = sun.halfSize, .zToDepth = 2 / (sun.zNearest - sun.zFarthest), .resolution = resolution};
  setRows(sun.toClip(), view.rows, view.moved);
  shadow_.resizeDiscarding(std::int64_t{resolution} * resolution);
  dispatch(device_, [&](auto& device) { splatShadow(device, spheres_.view(), view, shadow_.view()); });
  replace(gl_, map, resolution, resolution, kDepth32F, onHost(shadow_, shadowCopy_));
}

}  // namespace weir::rendering::gl
