#include "plugins/rendering/gl/splat_pass.h"

#include "framework/compute/dispatch.h"
#include "plugins/rendering/gl/splat_views.h"

namespace weir::rendering::gl {

namespace {

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
  std::vector<ParticleView> balls;
  for (const ParticleView& view : views)
    if (!view.water) balls.push_back(view);
  return spheres_.load(balls);
}

void SplatPass::drawGeometry(const Frame& frame, const Targets& targets) {
  if (!replacesAll()) return;
  const std::int64_t samples = std::int64_t{frame.width} * frame.height;
  nearest_.resizeDiscarding(samples);
  albedo_.resizeDiscarding(samples);
  normal_.resizeDiscarding(samples);
  depth_.resizeDiscarding(samples);
  dispatch(device_, [&](auto& device) {
    splatGeometry(device, spheres_.view(), splatCameraOf(frame), nearest_.view(),
                  {albedo_.view(), normal_.view(), depth_.view()});
  });
  replace(gl_, targets.albedo, frame.width, frame.height, kSrgb8, albedoCopy_.of(albedo_).data());
  replace(gl_, targets.normal, frame.width, frame.height, kNormal, normalCopy_.of(normal_).data());
  replace(gl_, targets.depth, frame.width, frame.height, kDepth32F, depthCopy_.of(depth_).data());
}

void SplatPass::drawShadow(const SunView& sun, const Texture& map, int resolution) {
  if (spheres_.view().size == 0) return;
  const SplatSun view = splatSunOf(sun, resolution);
  shadow_.resizeDiscarding(std::int64_t{resolution} * resolution);
  dispatch(device_, [&](auto& device) { splatShadow(device, spheres_.view(), view, shadow_.view()); });
  replace(gl_, map, resolution, resolution, kDepth32F, shadowCopy_.of(shadow_).data());
}

}  // namespace weir::rendering::gl
