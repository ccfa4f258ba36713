#include "texel.glsl"

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
