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

// Places in pairs, outwards. The range grows with what lies in it, so that slopes are not cut off.
const std::string kNarrowRangeShader = kShaderVersion + R"(
uniform sampler2D uNearness;
uniform int uStepX;  // 1: along x, 0: along y
uniform float uWidth;      // of the Gaussian at a distance of 1 m, in pixels
uniform float uRange;      // m
out float oNearness;

const int kPairs = 9;
const float kLargest = 60.0;  // pixels

void main() {
  ivec2 place = ivec2(gl_FragCoord.xy);
  float here = texelFetch(uNearness, place, 0).r;
  oNearness = here;
  if (here <= 0.0) return;
  float width = min(uWidth * here, 0.5 * kLargest);
  float stride = max(1.0, 2.0 * width / float(kPairs));
  float distance = 1.0 / here;
  float nearest = distance - uRange, farthest = distance + uRange;
  float behind = 1.0 / (distance + 0.35 * uRange);
  float sum = here, weights = 1.0;
  ivec2 last = textureSize(uNearness, 0) - 1;
  for (int i = 1; i <= kPairs; ++i) {
    int away = int(float(i) * stride + 0.5);
    float part = float(away) / width;
    float weight = exp(-0.5 * part * part);
    if (weight < 0.1) break;
    float a = texelFetch(uNearness, clamp(place + away * ivec2(uStepX, 1 - uStepX), ivec2(0), last), 0).r;
    float b = texelFetch(uNearness, clamp(place - away * ivec2(uStepX, 1 - uStepX), ivec2(0), last), 0).r;
    float da = a > 0.0 ? 1.0 / a : 1e9, db = b > 0.0 ? 1.0 / b : 1e9;
    if (da < nearest || db < nearest) continue;  // both, or the middle would move
    sum += weight * ((da > farthest ? behind : a) + (db > farthest ? behind : b));
    weights += 2.0 * weight;
    if (da <= farthest) {
      nearest = min(nearest, da - uRange);
      farthest = max(farthest, da + uRange);
    }
    if (db <= farthest) {
      nearest = min(nearest, db - uRange);
      farthest = max(farthest, db + uRange);
    }
  }
  oNearness = sum / weights;
}
)";

const std::string kBlurShader = kShaderVersion + R"(
uniform sampler2D uThickness, uNearness;
uniform int uStepX;  // 1: along x, 0: along y
uniform float uWidth;  // at a distance of 1 m, in texels
uniform vec2 uTexel;   // size of a texel, in texture coordinates
out vec2 oThickness;

const int kPairs = 4;

void main() {
  ivec2 place = ivec2(gl_FragCoord.xy);
  vec2 here = texelFetch(uThickness, place, 0).rg;
  oThickness = here;
  float nearness = abs(texture(uNearness, gl_FragCoord.xy * uTexel).r);
  if (nearness <= 0.0) return;
  float width = clamp(uWidth * nearness, 0.6, 12.0);
  float stride = max(1.0, 2.0 * width / float(kPairs));
  vec2 sum = here;
  float weights = 1.0;
  ivec2 last = textureSize(uThickness, 0) - 1;
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
  normal = makeTexture(gl, width * targets.samples, height * targets.samples, kColor10, GL_NEAREST);
  surface = makeFramebuffer(gl, {&normal}, &depth);
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
  // The second, narrower round takes away the streaks that the axes of the first one leave.
  for (const float share : {1.0f, 0.45f})
    for (int axis = 0; axis < 2; ++axis) {
      gl_.bindFramebuffer(GL_FRAMEBUFFER, water.nearnessTargets[1 - axis].name());
      narrowRange_.setTexture("uNearness", 0, water.nearness[axis]);
      narrowRange_.set("uStepX", axis == 0 ? 1 : 0);
      narrowRange_.set("uWidth", share * width * pixels);
      gl_.drawArrays(GL_TRIANGLES, 0, 3);
    }
}

void WaterSmoothing::smoothThickness(const Frame& frame, const WaterTargets& water, float width) const {
  gl_.disable(GL_DEPTH_TEST);
  gl_.viewport(0, 0, water.thicknessWidth, water.thicknessHeight);
  gl_.bindVertexArray(array_.name());
  blur_.use();
  blur_.set("uWidth", width * 0.5f * float(water.thicknessHeight) / frame.camera.tangent.y);
  blur_.set("uTexel", Vec2f{1.0f / float(water.thicknessWidth), 1.0f / float(water.thicknessHeight)});
  blur_.setTexture("uNearness", 1, water.nearness[0]);
  for (int axis = 0; axis < 2; ++axis) {
    gl_.bindFramebuffer(GL_FRAMEBUFFER, water.thicknessTargets[1 - axis].name());
    blur_.setTexture("uThickness", 0, water.thickness[axis]);
    blur_.set("uStepX", axis == 0 ? 1 : 0);
    gl_.drawArrays(GL_TRIANGLES, 0, 3);
  }
}

}  // namespace weir::rendering::gl
