#include "plugins/rendering/compute/compute_renderer.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "framework/base/check.h"
#include "plugins/rendering/gl/line_pass.h"
#include "plugins/rendering/gl/shadow_pass.h"
#include "plugins/rendering/gl/splat_views.h"

namespace weir::rendering {

namespace {

constexpr int kMaxSamples = 4;

const int kTilesPerRow = ShadowTiles::perRowOf(gl::ShadowPass::kResolution);

std::vector<float> linearOfBytes() {
  std::vector<float> table;
  for (int i = 0; i < 256; ++i) table.push_back(gl::linear({static_cast<float>(i) / 255, 0, 0, 1}).x);
  return table;
}

/// In linear light, after it was rounded to bytes, as OpenGL's passes have it.
Vec3f inBytes(const Color& color) {
  const auto byte = [](float x) { return std::round(255 * std::clamp(x, 0.0f, 1.0f)) / 255; };
  return gl::linear({byte(color.r), byte(color.g), byte(color.b), 1});
}

/// In camera space.
ShadedGround groundOf(const gl::Frame& frame) {
  const GroundView& ground = frame.view.ground;
  const Vec3f up = normalized(frame.view.worldUp);
  return {.visible = ground.visible,
          .middle = frame.camera.point(ground.center + up * (ground.height - dot(ground.center, up))),
          .up = frame.camera.direction(up),
          .radius = ground.radius,
          .color = inBytes(ground.color)};
}

ShadedLight lightOf(const gl::Frame& frame) {
  const View& view = frame.view;
  constexpr Vec3f kWhite{1, 1, 1};
  constexpr float kSoftTexels = 5;
  constexpr auto kTexels = static_cast<float>(gl::ShadowPass::kResolution);
  ShadedLight light{.sun = frame.camera.direction(normalized(view.lighting.towardsSun)),
                    .up = frame.camera.direction(normalized(view.worldUp)),
                    .sky = 0.5f * (kWhite + gl::linear(view.backgroundTop)),
                    .ground = gl::linear(view.ground.visible ? view.ground.color : view.backgroundBottom),
                    .background = {gl::linear(view.backgroundBottom), gl::linear(view.backgroundTop)},
                    .unlit = view.lighting.unlit};
  if (!frame.hasShadows) return light;
  gl::setRows(frame.sun.toTexture() * frame.camera.view.inverse(), light.toShadow, light.shadowMoved);
  light.shadowTexel = 2 * frame.sun.halfSize / kTexels;
  light.softness = kSoftTexels / kTexels;
  light.shadowResolution = gl::ShadowPass::kResolution;
  return light;
}

ShadedOcclusion occlusionOf(const gl::Frame& frame, const Aabb& casters) {
  constexpr float kLargestPart = 0.12f;
  const auto height = static_cast<float>(frame.height);
  return {.radius = gl::occlusionRadius(frame.view, casters),
          .radiusInView = 0.5f * height / frame.camera.tangent.y,
          .largest = kLargestPart * height};
}

/// The rectangle of six corners in clip space that lineCorners() gives.
ShadedLine shadedLine(const Vec4f* corners, int width, int height) {
  const auto place = [&](const Vec4f& corner) {
    return Vec3f{0.5f * (corner.x / corner.w + 1) * static_cast<float>(width),
                 0.5f * (corner.y / corner.w + 1) * static_cast<float>(height),
                 0.5f + 0.5f * corner.z / corner.w};
  };
  const Vec3f a = place(corners[0]), b = place(corners[1]), c = place(corners[2]), d = place(corners[5]);
  const Vec3f from = 0.5f * (a + b), to = 0.5f * (c + d);
  ShadedLine line{.from = {from.x, from.y}, .depth = from.z};
  line.length = std::hypot(to.x - from.x, to.y - from.y);
  line.along = {(to.x - from.x) / line.length, (to.y - from.y) / line.length};
  line.halfWidth = 0.5f * std::hypot(b.x - a.x, b.y - a.y);
  line.depthStep = (to.z - from.z) / line.length;
  line.lowest = std::min({a.y, b.y, c.y, d.y});
  line.highest = std::max({a.y, b.y, c.y, d.y});
  return line;
}

}  // namespace

ComputeRenderer::ComputeRenderer(Device& device)
    : device_(device),
      spheres_(device),
      nearest_(device),
      shadow_(device),
      linear_(device, std::span<const float>(linearOfBytes())),
      open_(device),
      scratch_(device),
      distances_(device),
      tiles_{Array<float>(device), Array<float>(device), Array<float>(device), Array<float>(device)},
      rgb_(device),
      lines_(device),
      picture_(device) {}

bool ComputeRenderer::canDraw(const View& view) {
  std::size_t points = 0;
  for (const LineView& lines : view.lines) points += lines.points.size();
  const LightingView& lighting = view.lighting;
  const bool plain = lighting.tone == ToneCurve::kPlain && lighting.exposure == 1 && view.ground.tiles == 0 &&
                     lighting.sunStrength == 1 && view.environment == EnvironmentLook::kStudio &&
                     !view.transparent;
  return plain && view.surfaces.empty() && view.waters.empty() && points <= 2 * kMaxLines;
}

void ComputeRenderer::setLines(const gl::Frame& frame) {
  std::vector<ShadedLine> all;
  for (const LineView& lines : frame.view.lines) {
    const float aspect = static_cast<float>(frame.width) / static_cast<float>(frame.height);
    const float halfWidth = lines.width / 720.0f;  // of 720 pixels' height, in clip space, which is 2 high
    const std::vector<Vec4f> corners =
        gl::lineCorners(frame.camera, lines.points, {halfWidth / aspect, halfWidth});
    for (std::size_t i = 0; i < corners.size(); i += 6) {
      ShadedLine& line = all.emplace_back(shadedLine(&corners[i], frame.width, frame.height));
      line.color = gl::linear(lines.color);
      line.opacity = lines.color.a;
    }
  }
  lines_.assign(all);
}

ShadedPicture ComputeRenderer::shadedPicture(const gl::Frame& frame) {
  const auto constView = [](const auto& array) { return array.view(); };
  const bool occluded = frame.view.lighting.occlusion && !frame.view.lighting.unlit;
  return {
      .seen = {.camera = gl::splatCameraOf(frame),
               .spheres = spheres_.view(),
               .nearest = constView(nearest_),
               .ground = groundOf(frame)},
      .samples = frame.samples,
      .width = frame.view.width,
      .height = frame.view.height,
      .light = lightOf(frame),
      .linear = constView(linear_),
      .lines = constView(lines_),
      .shadow = {reinterpret_cast<const float*>(shadow_.data()), shadow_.size()},
      .tiles = {.nearest = constView(tiles_[0]), .farthest = constView(tiles_[1]), .perRow = kTilesPerRow},
      .open = occluded ? constView(open_) : ArrayView<const float>{}};
}

Picture ComputeRenderer::draw(const View& view) {
  WEIR_CHECK(view.width > 0);
  WEIR_CHECK(view.height > 0);
  WEIR_CHECK(view.samplesPerAxis > 0);
  const Aabb casters = spheres_.load(view.particles);
  const int samples = std::min(view.samplesPerAxis, kMaxSamples);
  gl::Frame frame{
      .view = view,
      .samples = samples,
      .width = view.width * samples,
      .height = view.height * samples,
      .camera = gl::makeCamera(view.camera, static_cast<float>(view.width) / static_cast<float>(view.height),
                               gl::seenBox(view, casters))};
  frame.hasShadows = view.lighting.shadows && !view.lighting.unlit && !casters.empty();
  if (frame.hasShadows)
    frame.sun = gl::makeSunView(view.lighting.towardsSun, casters, gl::ShadowPass::kResolution);

  const std::int64_t pixels = std::int64_t{view.width} * view.height;
  const std::int64_t places = pixels * samples * samples;
  nearest_.resizeDiscarding(places);
  constexpr std::int64_t kTexels = std::int64_t{gl::ShadowPass::kResolution} * gl::ShadowPass::kResolution;
  shadow_.resizeDiscarding(kTexels);
  for (Array<float>* const each : {&open_, &scratch_, &distances_}) each->resizeDiscarding(pixels);
  rgb_.resizeDiscarding(3 * pixels);
  for (Array<float>& each : tiles_) each.resizeDiscarding(std::int64_t{kTilesPerRow} * kTilesPerRow);
  setLines(frame);
  const ShadedPicture shaded = shadedPicture(frame);
  dispatch(device_, [&](auto& device) {
    showGround(device, shaded.seen, nearest_.view());
    gl::splatDepths(device, spheres_.view(), shaded.seen.camera, nearest_.view());
    if (frame.hasShadows) {
      gl::splatShadow(device, spheres_.view(), gl::splatSunOf(frame.sun, gl::ShadowPass::kResolution),
                      shadow_.view());
      findShadowTiles(device, shaded.shadow, gl::ShadowPass::kResolution, tiles_[0].view(), tiles_[1].view(),
                      tiles_[2].view(), tiles_[3].view());
    }
    if (shaded.open.size > 0)
      findOcclusion(device, shaded.seen, samples, occlusionOf(frame, casters), open_.view(), scratch_.view(),
                    distances_.view());
    shade(device, shaded, rgb_.view());
  });
  const std::span<const std::uint8_t> rgb = picture_.of(rgb_);
  return {view.width, view.height, {rgb.begin(), rgb.end()}};
}

}  // namespace weir::rendering
