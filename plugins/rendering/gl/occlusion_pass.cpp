#include "plugins/rendering/gl/occlusion_pass.h"

#include <array>
#include <cmath>
#include <numbers>

#include "plugins/rendering/gl/shaders.h"

namespace weir::rendering::gl {
namespace {

constexpr int kTaps = 11;

Vec2f spiral(int number, int count) {
  constexpr float kTurns = 7;  // no common factor with the taps
  const float part = (float(number) + 0.5f) / float(count);
  const float angle = 2 * std::numbers::pi_v<float> * kTurns * part;
  return {part * std::cos(angle), part * std::sin(angle)};
}

Vec2f evenTurn(int number, int count) {
  const float angle = float(number) * (2 * std::numbers::pi_v<float> / float(count));
  return {std::cos(angle), std::sin(angle)};
}

const std::string kEstimateShader = kShaderVersion + kCameraSnippet + kNormalSnippet +
                                    placesInCircle("kPlaces", kTaps, spiral) +
                                    placesInCircle("kTurns", 16, evenTurn) + R"(
uniform sampler2D uDepth, uNormal;
uniform int uSamples;        // per pixel and axis
uniform float uRadius;       // m
uniform float uRadiusInView; // of 1 m at a distance of 1 m, in window coordinates of samples
uniform float uLargest;      // in the same
out float oOpen;

vec3 positionAt(ivec2 place) {
  return rayAt(vec2(place) + 0.5) * distanceAt(texelFetch(uDepth, place, 0).r);
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  ivec2 place = pixel * uSamples + uSamples / 2;
  float depth = texelFetch(uDepth, place, 0).r;
  vec3 position = rayAt(vec2(place) + 0.5) * distanceAt(depth);
  vec3 normal = normalOf(texelFetch(uNormal, place, 0).rg);
  float reach = min(uRadius * uRadiusInView / -position.z, uLargest);
  ivec2 last = textureSize(uDepth, 0) - 1;
  vec2 turn = reach * kTurns[(pixel.x & 3) * 4 + (pixel.y & 3) * 7 & 15];
  float sum = 0.0;
  for (int i = 0; i < kPlaces.length(); ++i) {
    vec2 at = vec2(kPlaces[i].x * turn.x - kPlaces[i].y * turn.y, kPlaces[i].x * turn.y + kPlaces[i].y * turn.x);
    ivec2 tap = place + ivec2(round(at));
    vec3 towards = positionAt(clamp(tap, ivec2(0), last)) - position;
    float within = max(uRadius * uRadius - dot(towards, towards), 0.0);
    float above = max(dot(towards, normal) - 0.02 * uRadius, 0.0);
    sum += within * within * within * above / (dot(towards, towards) + 1e-3 * uRadius * uRadius);
  }
  float hemmedIn = sum * 5.0 / (pow(uRadius, 5.0) * float(kPlaces.length()));
  oOpen = depth >= 1.0 ? 1.0 : max(0.0, 1.0 - hemmedIn);
}
)";

const std::string kBlurShader = kShaderVersion + kCameraSnippet + R"(
uniform sampler2D uOpen, uDepth;
uniform int uSamples;
uniform int uStepX;  // 1: along x, 0: along y
uniform float uRadius;
out float oOpen;

float distanceOf(ivec2 pixel) {
  return distanceAt(texelFetch(uDepth, pixel * uSamples + uSamples / 2, 0).r);
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  ivec2 last = textureSize(uOpen, 0) - 1;
  float here = distanceOf(pixel);
  float sum = 0.0, weights = 0.0;
  for (int i = -2; i <= 2; ++i) {
    ivec2 place = clamp(pixel + i * ivec2(uStepX, 1 - uStepX), ivec2(0), last);
    float away = (distanceOf(place) - here) / (0.5 * uRadius);
    // Five taps of which the outer two count half: as wide as the pattern, and in the middle.
    float weight = (abs(i) == 2 ? 0.5 : 1.0) * max(1.0 - away * away, 0.0);
    sum += weight * texelFetch(uOpen, place, 0).r;
    weights += weight;
  }
  oOpen = sum / weights;  // the middle one always counts
}
)";

}  // namespace

OcclusionPass::OcclusionPass(const Functions& gl)
    : gl_(gl),
      estimate_(gl, "occlusion", kFullScreenVertexShader, kEstimateShader),
      blur_(gl, "blur of the occlusion", kFullScreenVertexShader, kBlurShader),
      array_(makeVertexArray(gl)) {}

void OcclusionPass::draw(const Frame& frame, const Targets& targets, float radius) const {
  gl_.disable(GL_DEPTH_TEST);
  gl_.viewport(0, 0, targets.pictureWidth, targets.pictureHeight);
  gl_.bindVertexArray(array_.name());

  gl_.bindFramebuffer(GL_FRAMEBUFFER, targets.occlusionTargets[0].name());
  estimate_.use();
  setCameraUniforms(estimate_, frame.camera, frame.width, frame.height);
  estimate_.setTexture("uDepth", 0, targets.depth);
  estimate_.setTexture("uNormal", 1, targets.normal);
  estimate_.set("uSamples", frame.samples);
  estimate_.set("uRadius", radius);
  estimate_.set("uRadiusInView", 0.5f * float(frame.height) / frame.camera.tangent.y);
  // Farther taps say little, and fetch from all over the memory.
  constexpr float kLargestPart = 0.12f;
  estimate_.set("uLargest", kLargestPart * float(frame.height));
  gl_.drawArrays(GL_TRIANGLES, 0, 3);

  blur_.use();
  setCameraUniforms(blur_, frame.camera, frame.width, frame.height);
  blur_.setTexture("uDepth", 0, targets.depth);
  blur_.set("uSamples", frame.samples);
  blur_.set("uRadius", radius);
  for (int axis = 0; axis < 2; ++axis) {
    gl_.bindFramebuffer(GL_FRAMEBUFFER, targets.occlusionTargets[1 - axis].name());
    blur_.setTexture("uOpen", 1, targets.occlusion[axis]);
    blur_.set("uStepX", axis == 0 ? 1 : 0);
    gl_.drawArrays(GL_TRIANGLES, 0, 3);
  }
}

void OcclusionPass::clear(const Targets& targets) const {
  constexpr std::array<float, 4> kOpen{1, 1, 1, 1};
  gl_.bindFramebuffer(GL_FRAMEBUFFER, targets.occlusionTargets[0].name());
  gl_.clearBufferfv(GL_COLOR, 0, kOpen.data());
}

}  // namespace weir::rendering::gl
