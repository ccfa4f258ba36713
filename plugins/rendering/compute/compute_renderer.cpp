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

constexpr std::size_t kMostLines = 256;  // each sample looks at all of them
constexpr int kMostSamples = 4;

std::vector<float> linearOfBytes() {
  std::vector<float> table;
  for (int i = 0; i < 256; ++i) table.push_back(gl::linear({static_cast<float>(i) / 255, 0, 0, 1}).x);
  return table;
}

std::uint32_t packedColor(const Color& color, std::uint32_t material) {
  const auto byte = [](float x) {
    return static_cast<std::uint32_t>(std::lround(255 * std::clamp(x, 0.0f, 1.0f)));
  };
  return byte(color.r) | byte(color.g) << 8 | byte(color.b) << 16 | material << 24;
}

/// In camera space.
ShadedGround groundOf(const gl::Frame& frame) {
  constexpr std::uint32_t kGroundMaterial = 255;  // kGround of kMaterialSnippet, in eight bits
  const GroundView& ground = frame.view.ground;
  const Vec3f up = normalized(frame.view.worldUp);
  return {.visible = ground.visible,
          .middle = frame.camera.point(ground.center + up * (ground.height - dot(ground.center, up))),
          .up = frame.camera.direction(up),
          .radius = ground.radius,
          .albedo = packedColor(ground.color, kGroundMaterial)};
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
  return line;
}

}  // namespace

ComputeRenderer::ComputeRenderer(Device& device)
    : device_(device),
      spheres_(device),
      nearest_(device),
      albedo_(device),
      normal_(device),
      shadow_(device),
      depth_(device),
      linear_(device, std::span<const float>(linearOfBytes())),
      open_(device),
      scratch_(device),
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
  return plain && view.surfaces.empty() && view.waters.empty() && points <= 2 * kMostLines;
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

ShadedPicture ComputeRenderer::shadedPicture(const gl::Frame& frame, const ShadedGround& ground) {
  const auto constView = [](const auto& array) { return array.view(); };
  return {.camera = gl::splatCameraOf(frame),
          .samples = frame.samples,
          .width = frame.view.width,
          .height = frame.view.height,
          .light = lightOf(frame),
          .ground = ground,
          .linear = constView(linear_),
          .lines = constView(lines_),
          .albedo = constView(albedo_),
          .normal = constView(normal_),
          .depth = constView(depth_),
          .shadow = constView(shadow_),
          .open = constView(open_)};
}

Picture ComputeRenderer::draw(const View& view) {
  WEIR_CHECK(view.width > 0);
  WEIR_CHECK(view.height > 0);
  WEIR_CHECK(view.samplesPerAxis > 0);
  const Aabb casters = spheres_.load(view.particles);
  const int samples = std::min(view.samplesPerAxis, kMostSamples);
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
  albedo_.resizeDiscarding(places);
  normal_.resizeDiscarding(places);
  depth_.resizeDiscarding(places);
  constexpr std::int64_t kTexels = std::int64_t{gl::ShadowPass::kResolution} * gl::ShadowPass::kResolution;
  shadow_.resizeDiscarding(kTexels);
  open_.resizeDiscarding(pixels);
  scratch_.resizeDiscarding(pixels);
  rgb_.resizeDiscarding(3 * pixels);
  setLines(frame);
  const ShadedGround ground = groundOf(frame);
  const ShadedPicture shaded = shadedPicture(frame, ground);
  const gl::SplatTexels texels{albedo_.view(), normal_.view(), depth_.view()};
  dispatch(device_, [&](auto& device) {
    gl::splatGeometry(device, spheres_.view(), shaded.camera, nearest_.view(), texels);
    addGround(device, shaded.camera, ground, texels);
    if (frame.hasShadows)
      gl::splatShadow(device, spheres_.view(), gl::splatSunOf(frame.sun, gl::ShadowPass::kResolution),
                      shadow_.view());
    if (view.lighting.occlusion && !view.lighting.unlit)
      findOcclusion(device, shaded, occlusionOf(frame, casters), open_.view(), scratch_.view());
    else
      device.fillBytes(open_.data(), 255, static_cast<std::size_t>(pixels));
    shade(device, shaded, rgb_.view());
  });
  return download(view);
}

Picture ComputeRenderer::download(const View& view) {
  picture_.resize(rgb_.size());
  picture_.start(0, rgb_.data(), rgb_.size());
  const std::span<const std::uint8_t> rgb = picture_.wait();
  return {view.width, view.height, {rgb.begin(), rgb.end()}};
}

}  // namespace weir::rendering
