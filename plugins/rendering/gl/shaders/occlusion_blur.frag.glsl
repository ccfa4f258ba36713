#include "camera.glsl"

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
    float weight = weightOfOpenSky(distanceOf(place) - here, i, uRadius);
    sum += weight * texelFetch(uOpen, place, 0).r;
    weights += weight;
  }
  oOpen = sum / weights;  // the middle one always counts
}
