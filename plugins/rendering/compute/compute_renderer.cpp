#include "plugins/rendering/compute/compute_renderer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "framework/base/check.h"
#include "framework/base/error.h"
#include "framework/compute/dispatch.h"
#include "plugins/rendering/compute/seen_sphere_kernels.h"
#include "plugins/rendering/gl/frame.h"
#include "plugins/rendering/gl/line_pass.h"
#include "plugins/rendering/gl/splat_views.h"

namespace weir::rendering {

namespace {

const int kTilesPerRow = ShadowTiles::perRowOf(kShadowResolution);

gl::Frame frameOf(const View& view, const Aabb& casters) {
  WEIR_CHECK(view.width > 0);
  WEIR_CHECK(view.height > 0);
  WEIR_CHECK(view.samplesPerAxis > 0);
  return gl::makeFrame(view, std::min(view.samplesPerAxis, gl::kMaxSamples), casters);
}

std::vector<float> linearOfBytes() {
  std::vector<float> table;
  for (int i = 0; i < 256; ++i) table.push_back(gl::linear({static_cast<float>(i) / 255, 0, 0, 1}).x);
  return table;
}

/// In camera space.
ShadedGround groundOf(const gl::Frame& frame) {
  const GroundView& ground = frame.view.ground;
  return {.visible = ground.visible,
          .middle = frame.camera.point(gl::groundMiddle(frame.view)),
          .up = frame.camera.direction(normalized(frame.view.worldUp)),
          .radius = ground.radius,
          .color = gl::linear(gl::inBytes(ground.color))};
}

ShadowMap shadowMapOf(const gl::Frame& frame) {
  if (!frame.hasShadows) return {};
  return {gl::affineMap(gl::toShadowMap(frame)), kShadowResolution};
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
    : device_(device), linear_(device, std::span<const float>(linearOfBytes())) {}

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
    const std::vector<Vec4f> corners = gl::lineCorners(frame, lines);
    for (std::size_t i = 0; i < corners.size(); i += 6) {
      ShadedLine& line = all.emplace_back(shadedLine(&corners[i], frame.width, frame.height));
      line.color = gl::linear(lines.color);
      line.opacity = lines.color.a;
    }
  }
  lines_.assign(all);
}

ShadedPicture ComputeRenderer::shadedPicture(const gl::Frame& frame, ArrayView<const SplatSphere> spheres) {
  const auto constView = [](const auto& array) { return array.view(); };
  const bool occluded = frame.view.lighting.occlusion && !frame.view.lighting.unlit;
  return {.seen = {.camera = gl::splatCameraOf(frame),
                   .spheres = spheres,
                   .nearest = constView(nearest_),
                   .ground = groundOf(frame)},
          .samples = frame.samples,
          .width = frame.view.width,
          .height = frame.view.height,
          .light = gl::lightOf(frame),
          .shadowMap = shadowMapOf(frame),
          .linear = constView(linear_),
          .lines = constView(lines_),
          .shadow = {reinterpret_cast<const float*>(shadow_.data()), shadow_.size()},
          .tiles = {.depths = constView(tiles_), .perRow = kTilesPerRow},
          .open = occluded ? constView(open_) : ArrayView<const float>{}};
}

/// A picture without spheres.
void ComputeRenderer::clearToGround(const gl::Frame& frame) {
  nearest_.resizeDiscarding(std::int64_t{frame.width} * frame.height);
  const SeenSamples seen{
      .camera = gl::splatCameraOf(frame), .spheres = {}, .nearest = {}, .ground = groundOf(frame)};
  dispatch(device_, [&](auto& device) { showGround(device, seen, nearest_.view()); });
}

/// The spheres that were loaded, for the camera and for the sun.
void ComputeRenderer::splat(const gl::Frame& frame) {
  clearToGround(frame);
  constexpr std::int64_t kTexels = std::int64_t{kShadowResolution} * kShadowResolution;
  shadow_.resizeDiscarding(kTexels);
  dispatch(device_, [&](auto& device) {
    gl::splatDepths(device, spheres_.opaque().spheres, gl::splatCameraOf(frame), nearest_.view());
    if (!frame.hasShadows) return;
    gl::clearDepths(device, shadow_.view());
    gl::splatSunDepths(device, spheres_.opaque().casting, gl::splatSunOf(frame.sun, kShadowResolution),
                       shadow_.view());
  });
}

Picture ComputeRenderer::shaded(const gl::Frame& frame, const Aabb& casters,
                                ArrayView<const SplatSphere> spheres) {
  const std::int64_t pixels = std::int64_t{frame.view.width} * frame.view.height;
  for (Array<float>* const each : {&open_, &scratch_, &distances_}) each->resizeDiscarding(pixels);
  rgb_.resizeDiscarding(3 * pixels);
  for (Array<Vec2f>* const each : {&tiles_, &tileScratch_})
    each->resizeDiscarding(std::int64_t{kTilesPerRow} * kTilesPerRow);
  setLines(frame);
  const ShadedPicture shaded = shadedPicture(frame, spheres);
  dispatch(device_, [&](auto& device) {
    if (frame.hasShadows)
      findShadowTiles(device, shaded.shadow, kShadowResolution, tiles_.view(), tileScratch_.view());
    if (shaded.open.size > 0)
      findOcclusion(device, shaded.seen, frame.samples, gl::occlusionOf(frame, casters), open_.view(),
                    scratch_.view(), distances_.view());
    shade(device, shaded, rgb_.view());
  });
  const std::span<const std::uint8_t> rgb = picture_.of(rgb_);
  return {frame.view.width, frame.view.height, {rgb.begin(), rgb.end()}};
}

Picture ComputeRenderer::draw(const View& view) {
  const Aabb casters = spheres_.load(view.particles);
  const gl::Frame frame = frameOf(view, casters);
  splat(frame);
  return shaded(frame, casters, spheres_.opaque().spheres);
}

SeenOfRanks ComputeRenderer::seenOf(const View& view, Communicator& ranks) {
  SeenOfRanks seen;
  for (const Aabb& of : ranks.allGather(spheres_.load(view.particles))) seen.casters.extend(of);
  const gl::Frame frame = frameOf(view, seen.casters);
  seen.largestRadius = ranks.max(frame.largestRadius);
  splat(frame);
  ends_.assign(spheres_.opaqueEnds());
  // In parts, so that little is on its way.
  constexpr std::int64_t kAtOnce = std::int64_t{1} << 20;
  for (std::int64_t first = 0; first < nearest_.size(); first += kAtOnce) {
    const std::vector<SeenSphere> part =
        nearestOfRanks(ranks, listed(first, std::min(kAtOnce, nearest_.size() - first)));
    seen.spheres.insert(seen.spheres.end(), part.begin(), part.end());
  }
  if (frame.hasShadows) seen.shadow = nearestOfRanks(ranks, shadow_.toHost());
  return seen;
}

/// What is seen at some of the samples.
std::vector<SeenSphere> ComputeRenderer::listed(std::int64_t first, std::int64_t count) {
  const ArrayView<const std::uint64_t> nearest{nearest_.data() + first, count};
  samples_.resizeDiscarding(count);
  dispatch(device_, [&](auto& device) { findSeen(device, nearest, samples_.view(), found_.data()); });
  const std::int64_t found = found_.toHost().front();
  listed_.resizeDiscarding(found);
  dispatch(device_, [&](auto& device) {
    listSeen(device, nearest, first, {samples_.data(), found}, spheres_.opaque().spheres,
             std::as_const(ends_).view(), listed_.view());
  });
  return listed_.toHost();
}

Picture ComputeRenderer::draw(const View& view, const SeenOfRanks& seen) {
  gl::Frame frame = frameOf(view, seen.casters);
  frame.largestRadius = seen.largestRadius;
  clearToGround(frame);
  shadow_.assign(seen.shadow);
  const ArrayView<const SeenSphere> all = seen_.of(seen.spheres, false);
  placed_.resizeDiscarding(all.size);
  dispatch(device_, [&](auto& device) { placeSeen(device, all, nearest_.view(), placed_.view()); });
  return shaded(frame, seen.casters, std::as_const(placed_).view());
}

MeshId ComputeRenderer::addMesh(const TriangleMesh&) {
  throw ioError("the device alone draws no surfaces");
}

void ComputeRenderer::replaceMesh(MeshId, const ShownMesh&) {
  throw ioError("the device alone draws no surfaces");
}

}  // namespace weir::rendering
