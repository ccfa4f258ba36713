#include "plugins/rendering/gl/water_splat_pass.h"

#include <algorithm>

#include "framework/base/check.h"
#include "framework/compute/dispatch.h"
#include "plugins/rendering/gl/splat_views.h"

namespace weir::rendering::gl {

namespace {

ThicknessView thicknessView(const Eigen::Matrix4f& toClip, const ThicknessMap& map) {
  ThicknessView view{.width = map.width, .height = map.height};
  for (int i = 0; i < 4; ++i) {
    view.rows[i] = {toClip(i, 0), toClip(i, 1), toClip(i, 2)};
    view.moved[i] = toClip(i, 3);
  }
  return view;
}

}  // namespace

WaterSplatPass::WaterSplatPass(const Functions& gl, Device& device)
    : gl_(gl),
      device_(device),
      depth_(device),
      sunDepth_(device),
      sums_(device),
      background_(device),
      thickness_(device),
      depthCopy_(device),
      thicknessCopy_(device) {}

Aabb WaterSplatPass::load(std::span<const ParticleView> views) {
  for (Liquid& liquid : liquids_) liquid.packed.clear(), liquid.largest = 0;
  Aabb box;
  for (const ParticleView& view : views)
    if (view.water) box.extend(loadOne(view));
  for (Liquid& liquid : liquids_) liquid.particles.assign(liquid.packed);
  return box;
}

Aabb WaterSplatPass::loadOne(const ParticleView& particles) {
  const bool foams = !particles.foam.empty();
  if (foams) WEIR_CHECK(particles.foam.size() == particles.positions.size());
  while (liquids_.size() <= *particles.water) liquids_.emplace_back(device_);
  Liquid& liquid = liquids_[*particles.water];
  const float inset = insetOf(particles);
  const float chord = chordOf(particles);
  Aabb box;
  for (std::size_t i = 0; i < particles.positions.size(); ++i) {
    const Vec3f& p = particles.positions[i];
    if (!isFinite(p)) continue;
    box.extend(p);
    liquid.packed.push_back({p, particles.radius, foams ? particles.foam[i] : 0.0f, inset, chord});
  }
  if (box.empty()) return box;
  liquid.largest = std::max(liquid.largest, particles.radius);
  const Vec3f around{particles.radius, particles.radius, particles.radius};
  return {box.lo - around, box.hi + around};
}

void WaterSplatPass::upload(const Texture& texture, int width, int height, const TextureFormat& format,
                            const void* texels) const {
  gl_.bindTexture(GL_TEXTURE_2D, texture.name());
  gl_.texSubImage2D(GL_TEXTURE_2D, 0, 0, 0, width, height, format.format, format.type, texels);
}

void WaterSplatPass::drawDepth(const Frame& frame, std::size_t water, const Texture& depth) {
  if (!has(water)) return;
  const SplatCamera camera = splatCameraOf(frame);
  depth_.resizeDiscarding(std::int64_t{frame.width} * frame.height);
  dispatch(device_, [&](auto& device) {
    splatWaterDepth(device, liquids_[water].particles.view(), camera, depth_.view());
  });
  upload(depth, frame.width, frame.height, kDepth32F, depthCopy_.of(depth_).data());
}

void WaterSplatPass::drawThickness(const Frame& frame, std::size_t water, const Texture&,
                                   const LiquidBackground& background, const ThicknessMap& map) {
  if (!has(water)) return;
  ThicknessView view = thicknessView(frame.camera.projection() * frame.camera.view, map);
  view.texels = 0.5f * float(map.height) / frame.camera.tangent.y;
  view.near = frame.camera.near;
  backgroundOnHost_.resize(std::size_t(map.width) * std::size_t(map.height));
  gl_.bindFramebuffer(GL_FRAMEBUFFER, background.target.name());
  gl_.readPixels(0, 0, map.width, map.height, kFloat1.format, kFloat1.type, backgroundOnHost_.data());
  background_.assign(backgroundOnHost_);
  const auto constView = [](const auto& array) { return array.view(); };
  addThickness(water, view,
               {.front = constView(depth_),
                .background = constView(background_),
                .width = frame.width,
                .height = frame.height,
                .projection = frame.camera.projectionTerms(),
                .depthOfFoam = kFoamDepth},
               map);
}

void WaterSplatPass::drawSunDepth(const SunView& sun, std::size_t water, const Texture& depth,
                                  int resolution) {
  if (!has(water)) return;
  const SplatSun view = splatSunOf(sun, resolution);
  sunDepth_.resizeDiscarding(std::int64_t{resolution} * resolution);
  dispatch(device_, [&](auto& device) {
    splatWaterSunDepth(device, liquids_[water].particles.view(), view, sunDepth_.view());
  });
  upload(depth, resolution, resolution, kDepth32F, depthCopy_.of(sunDepth_).data());
}

void WaterSplatPass::drawSunThickness(const SunView& sun, std::size_t water, const ThicknessMap& map) {
  if (!has(water)) return;
  ThicknessView view = thicknessView(sun.toClip(), map);
  view.texels = 0.5f * float(map.height) / sun.halfSize;
  addThickness(water, view, {}, map);
}

void WaterSplatPass::addThickness(std::size_t water, ThicknessView view, const LiquidBetween& between,
                                  const ThicknessMap& map) {
  // So fine that small shares of a particle count, so coarse that a million of them fit into a sum.
  view.unit = liquids_[water].largest / 2048;
  const std::int64_t texels = std::int64_t{map.width} * map.height;
  sums_.resizeDiscarding(2 * texels);
  thickness_.resizeDiscarding(texels);
  dispatch(device_, [&](auto& device) {
    splatThickness(device, liquids_[water].particles.view(), view, between, sums_.view(), thickness_.view());
  });
  upload(map.texture, map.width, map.height, kFloat2, thicknessCopy_.of(thickness_).data());
}

}  // namespace weir::rendering::gl
