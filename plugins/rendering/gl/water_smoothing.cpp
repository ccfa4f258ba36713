#include "plugins/rendering/gl/water_smoothing.h"

#include "plugins/rendering/gl/shaders.h"

namespace weir::rendering::gl {
namespace {

const std::string kGatherShader = kShaderVersion + kCameraSnippet + R"(
uniform sampler2D uDepth, uNormal;
uniform int uSamples;
out float oNearness;

void main() {
  ivec2 first = ivec2(gl_FragCoord.xy) * uSamples;
  float nearest = 1.0;
  ivec2 where = first;
  for (int y = 0; y < uSamples; ++y)
    for (int x = 0; x < uSamples; ++x) {
      float depth = texelFetch(uDepth, first + ivec2(x, y), 0).r;
      if (depth < nearest) where = first + ivec2(x, y);
      nearest = min(nearest, depth);
    }
  if (nearest >= 1.0) {
    oNearness = 0.0;
    return;
  }
  bool mesh = texelFetch(uNormal, where, 0).a > 0.5;
  oNearness = (mesh ? -1.0 : 1.0) / distanceAt(nearest);
}
)";

// Places in pairs, outwards. The range grows with what lies in it, so that slopes are not cut off. All limits
// are soft, or spray would become noise.
const std::string kNarrowRangeShader = kShaderVersion + R"(
uniform sampler2D uNearness;
uniform int uStepX;        // 1: along x, 0: along y
uniform float uWidth;      // of the Gaussian at a distance of 1 m, in pixels
uniform float uRange;      // m
out float oNearness;

const int kPairs = 9;
const float kLargest = 60.0;  // pixels

// What lies behind the range counts as if it were a little behind the middle.
float drawnNear(float distance, float farthest, float behind) {
  return distance <= farthest ? distance : max(behind, 2.0 * farthest - distance);
}

void main() {
  ivec2 place = ivec2(gl_FragCoord.xy);
  float here = texelFetch(uNearness, place, 0).r;
  oNearness = here;
  if (here <= 0.0) return;
  ivec2 unit = ivec2(uStepX, 1 - uStepX);
  float width = min(uWidth * here, 0.5 * kLargest);
  float stride = max(1.0, 2.0 * width / float(kPairs));
  float distance = 1.0 / here;
  float nearest = distance - uRange, farthest = distance + uRange;
  float behind = distance + 0.2 * uRange;
  float sum = here, weights = 1.0;
  ivec2 last = textureSize(uNearness, 0) - 1;
  for (int i = 1; i <= kPairs; ++i) {
    int away = int(float(i) * stride + 0.5);
    float part = float(away) / width;
    float weight = exp(-0.5 * part * part);
    if (weight < 0.05) break;
    float a = texelFetch(uNearness, clamp(place + away * unit, ivec2(0), last), 0).r;
    float b = texelFetch(uNearness, clamp(place - away * unit, ivec2(0), last), 0).r;
    float da = abs(a) > 0.0 ? 1.0 / abs(a) : 1e9, db = abs(b) > 0.0 ? 1.0 / abs(b) : 1e9;
    float over = (nearest - min(da, db)) / uRange;  // both count less, or the middle would move
    weight *= 1.0 - smoothstep(0.0, 1.0, over);
    sum += weight * (1.0 / drawnNear(da, farthest, behind) + 1.0 / drawnNear(db, farthest, behind));
    weights += 2.0 * weight;
    if (over > 0.0) continue;
    nearest = min(nearest, min(da, db) - uRange);
    if (da <= farthest) farthest = max(farthest, da + uRange);
    if (db <= farthest) farthest = max(farthest, db + uRange);
  }
  oNearness = sum / weights;
}
)";

// A small round of both axes together takes away the streaks that the axes leave one by one.
const std::string kPolishShader = kShaderVersion + R"(
uniform sampler2D uNearness;
uniform float uRange;  // m
out float oNearness;

void main() {
  ivec2 place = ivec2(gl_FragCoord.xy);
  float here = texelFetch(uNearness, place, 0).r;
  oNearness = here;
  if (here <= 0.0) return;
  ivec2 last = textureSize(uNearness, 0) - 1;
  float sum = here, weights = 1.0;
  for (int y = -2; y <= 2; ++y)
    for (int x = -2; x <= 2; ++x) {
      if (x == 0 && y == 0) continue;
      float there = texelFetch(uNearness, clamp(place + ivec2(x, y), ivec2(0), last), 0).r;
      if (there <= 0.0) continue;
      float apart = (1.0 / there - 1.0 / here) / uRange;
      float weight = exp(-0.25 * float(x * x + y * y) - 2.0 * apart * apart);
      sum += weight * there;
      weights += weight;
    }
  oNearness = sum / weights;
}
)";

const std::string kBlurShader = kShaderVersion + kTexelSnippet + R"(
uniform sampler2D uThickness, uNearness;
uniform int uStepX;  // 1: along x, 0: along y
uniform float uWidth;  // at a distance of 1 m, in texels
out vec2 oThickness;

const int kPairs = 4;

void main() {
  ivec2 place = ivec2(gl_FragCoord.xy);
  vec2 here = texelFetch(uThickness, place, 0).rg;
  oThickness = here;
  ivec2 size = textureSize(uThickness, 0), last = size - 1;
  float nearness = abs(texelFetch(uNearness, texelUnder(place, size, textureSize(uNearness, 0)), 0).r);
  if (nearness <= 0.0) return;
  float width = clamp(uWidth * nearness, 0.6, 12.0);
  float stride = max(1.0, 2.0 * width / float(kPairs));
  vec2 sum = here;
  float weights = 1.0;
  for (int i = 1; i <= kPairs; ++i) {
    int away = int(float(i) * stride + 0.5);
    float part = float(away) / width;
    float weight = exp(-0.5 * part * part);
    sum += weight * (texelFetch(uThickness, clamp(place + away * ivec2(uStepX, 1 - uStepX), ivec2(0), last), 0).rg +
                     texelFetch(uThickness, clamp(place - away * ivec2(uStepX, 1 - uStepX), ivec2(0), last), 0).rg);
    weights += 2.0 * weight;
  }
  oThickness = sum / weights;
}
)";

}  // namespace

WaterTargets::WaterTargets(const Functions& gl, const Targets& targets)
    : thicknessWidth((targets.pictureWidth + 1) / 2), thicknessHeight((targets.pictureHeight + 1) / 2) {
  const int width = targets.pictureWidth, height = targets.pictureHeight;
  depth = makeTexture(gl, width * targets.samples, height * targets.samples, kDepth32F, GL_NEAREST);
  normal = makeTexture(gl, width * targets.samples, height * targets.samples, kColor16, GL_NEAREST);
  surface = makeFramebuffer(gl, {&normal}, &depth);
  background = makeTexture(gl, thicknessWidth, thicknessHeight, kFloat1, GL_NEAREST);
  backgroundTarget = makeFramebuffer(gl, {&background}, nullptr);
  for (int i = 0; i < 2; ++i) {
    thickness[i] = makeTexture(gl, thicknessWidth, thicknessHeight, kFloat2, GL_LINEAR);
    thicknessTargets[i] = makeFramebuffer(gl, {&thickness[i]}, nullptr);
    nearness[i] = makeTexture(gl, width, height, kFloat1, GL_NEAREST);
    nearnessTargets[i] = makeFramebuffer(gl, {&nearness[i]}, nullptr);
  }
  scene = makeTexture(gl, width, height, kColor16F, GL_LINEAR);
  sceneTarget = makeFramebuffer(gl, {&scene}, nullptr);
  shaded = makeTexture(gl, width, height, kColor16F, GL_NEAREST);
  shadedTarget = makeFramebuffer(gl, {&shaded}, nullptr);
}

WaterSmoothing::WaterSmoothing(const Functions& gl)
    : gl_(gl),
      gather_(gl, "nearness of a liquid", kFullScreenVertexShader, kGatherShader),
      narrowRange_(gl, "smooth surface of a liquid", kFullScreenVertexShader, kNarrowRangeShader),
      polish_(gl, "polished surface of a liquid", kFullScreenVertexShader, kPolishShader),
      blur_(gl, "smooth thickness of a liquid", kFullScreenVertexShader, kBlurShader),
      array_(makeVertexArray(gl)) {}

void WaterSmoothing::smoothSurface(const Frame& frame, const WaterTargets& water, float width) const {
  gl_.disable(GL_DEPTH_TEST);
  gl_.viewport(0, 0, frame.view.width, frame.view.height);
  gl_.bindVertexArray(array_.name());
  gl_.bindFramebuffer(GL_FRAMEBUFFER, water.nearnessTargets[0].name());
  gather_.use();
  setCameraUniforms(gather_, frame.camera, frame.width, frame.height);
  gather_.setTexture("uDepth", 0, water.depth);
  gather_.setTexture("uNormal", 1, water.normal);
  gather_.set("uSamples", frame.samples);
  gl_.drawArrays(GL_TRIANGLES, 0, 3);

  narrowRange_.use();
  const float pixels = 0.5f * float(frame.view.height) / frame.camera.tangent.y;  // of 1 m at 1 m
  narrowRange_.set("uRange", 2.5f * width);
  // The narrower rounds take away the streaks that the axes of the wider ones leave.
  for (const float share : {1.0f, 0.5f, 0.25f})
    for (int axis = 0; axis < 2; ++axis) {
      gl_.bindFramebuffer(GL_FRAMEBUFFER, water.nearnessTargets[1 - axis].name());
      narrowRange_.setTexture("uNearness", 0, water.nearness[axis]);
      narrowRange_.set("uStepX", axis == 0 ? 1 : 0);
      narrowRange_.set("uWidth", share * width * pixels);
      gl_.drawArrays(GL_TRIANGLES, 0, 3);
    }
  gl_.bindFramebuffer(GL_FRAMEBUFFER, water.nearnessTargets[1].name());
  polish_.use();
  polish_.setTexture("uNearness", 0, water.nearness[0]);
  polish_.set("uRange", width);
  gl_.drawArrays(GL_TRIANGLES, 0, 3);
}

void WaterSmoothing::smoothThickness(const Frame& frame, const WaterTargets& water, float width) const {
  gl_.disable(GL_DEPTH_TEST);
  gl_.viewport(0, 0, water.thicknessWidth, water.thicknessHeight);
  gl_.bindVertexArray(array_.name());
  blur_.use();
  blur_.set("uWidth", width * 0.5f * float(water.thicknessHeight) / frame.camera.tangent.y);
  blur_.setTexture("uNearness", 1, water.nearness[1]);
  for (int axis = 0; axis < 2; ++axis) {
    gl_.bindFramebuffer(GL_FRAMEBUFFER, water.thicknessTargets[1 - axis].name());
    blur_.setTexture("uThickness", 0, water.thickness[axis]);
    blur_.set("uStepX", axis == 0 ? 1 : 0);
    gl_.drawArrays(GL_TRIANGLES, 0, 3);
  }
}

}  // namespace weir::rendering::gl
