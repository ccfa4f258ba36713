#include "plugins/rendering/gl/splatted_spheres.h"

#include "framework/compute/dispatch.h"
#include "plugins/rendering/gl/splat_views.h"

namespace weir::rendering::gl {

namespace {

ThicknessView thicknessView(const Eigen::Matrix4f& toClip, const Texture& map, float viewHeight, float near) {
  ThicknessView view{
      .texels = float(map.height) / viewHeight, .near = near, .width = map.width, .height = map.height};
  for (int i = 0; i < 4; ++i) {
    view.rows[i] = {toClip(i, 0), toClip(i, 1), toClip(i, 2)};
    view.moved[i] = toClip(i, 3);
  }
  return view;
}

}  // namespace

void SplattedSpheres::drawGeometry(const Frame& frame, const Targets& targets) {
  if (!replacesAll()) return;
  const std::int64_t samples = std::int64_t{frame.width} * frame.height;
  nearest_.resizeDiscarding(samples);
  for (Array<std::uint32_t>* const each : {&albedo_, &normal_, &depth_}) each->resizeDiscarding(samples);
  dispatch(device_, [&](auto& device) {
    splatGeometry(device, spheres_.opaque().spheres, splatCameraOf(frame), nearest_.view(),
                  {albedo_.view(), normal_.view(), depth_.view()});
  });
  targets.albedo.replace(texels_.of(albedo_).data());
  targets.normal.replace(normals_.of(normal_).data());
  targets.depth.replace(depths_.of(depth_).data());
}

void SplattedSpheres::drawSunDepth(const SunView& sun, Liquid liquid, const Texture& depth) {
  if (!spheres_.has(liquid)) return;
  const SplatSun view = splatSunOf(sun, depth.width);
  sunDepth_.resizeDiscarding(std::int64_t{depth.width} * depth.width);
  dispatch(device_, [&](auto& device) {
    clearDepths(device, sunDepth_.view());
    for (const SphereSet::Part& part : spheres_.parts())
      if (part.liquid == liquid) splatSunDepths(device, part.casting, view, sunDepth_.view());
  });
  depth.replace(depths_.of(sunDepth_).data());
}

void SplattedSpheres::drawDepth(const Frame& frame, std::size_t liquid, const Texture& depth) {
  if (!spheres_.has(liquid)) return;
  const SplatCamera camera = splatCameraOf(frame);
  depth_.resizeDiscarding(std::int64_t{frame.width} * frame.height);
  dispatch(device_, [&](auto& device) {
    clearDepths(device, depth_.view());
    for (const SphereSet::Part& part : spheres_.parts())
      if (part.liquid == liquid) splatDepths(device, part.spheres, camera, part.inset, depth_.view());
  });
  depth.replace(depths_.of(depth_).data());
}

void SplattedSpheres::drawThickness(const Frame& frame, std::size_t liquid, const Texture&,
                                    const Canvas& background, const Texture& map) {
  if (!spheres_.has(liquid)) return;
  backgroundOnHost_.resize(std::size_t(map.width) * std::size_t(map.height));
  background.target.bind();
  background.target.gl().readPixels(0, 0, map.width, map.height, kFloat1.format, kFloat1.type,
                                    backgroundOnHost_.data());
  background_.assign(backgroundOnHost_);
  addThickness(liquid,
               thicknessView(frame.camera.projection() * frame.camera.view, map, 2 * frame.camera.tangent.y,
                             frame.camera.near),
               {.front = depth_.view(),
                .background = background_.view(),
                .width = frame.width,
                .height = frame.height,
                .projection = frame.camera.projectionTerms(),
                .depthOfFoam = kFoamDepth},
               map);
}

void SplattedSpheres::drawSunThickness(const SunView& sun, std::size_t liquid, const Texture& map) {
  if (!spheres_.has(liquid)) return;
  addThickness(liquid, thicknessView(sun.toClip(), map, 2 * sun.halfSize, 0), {}, map);
}

void SplattedSpheres::addThickness(std::size_t liquid, ThicknessView view, const LiquidBetween& between,
                                   const Texture& map) {
  const std::int64_t texels = std::int64_t{map.width} * map.height;
  sums_.resizeDiscarding(2 * texels);
  sums_.fillZero();
  thickness_.resizeDiscarding(texels);
  for (const SphereSet::Part& part : spheres_.parts())
    if (part.liquid == liquid) view.setUnitFor(part.radius);
  dispatch(device_, [&](auto& device) {
    for (const SphereSet::Part& part : spheres_.parts())
      if (part.liquid == liquid) addLiquid(device, part.spheres, part.chord, view, between, sums_.view());
    thicknessOf(device, sums_.view(), view.unit, thickness_.view());
  });
  map.replace(thicknesses_.of(thickness_).data());
}

}  // namespace weir::rendering::gl
