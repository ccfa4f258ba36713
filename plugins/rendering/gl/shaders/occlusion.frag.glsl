#include "camera.glsl"
#include "normal.glsl"
#include "patterns.glsl"

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
  float reach = reachOfOcclusion(-position.z, uRadius, uRadiusInView, uLargest);
  ivec2 last = textureSize(uDepth, 0) - 1;
  vec2 turn = reach * kOcclusionTurns[(pixel.x & 3) * 4 + (pixel.y & 3) * 7 & 15];
  float sum = 0.0;
  for (int i = 0; i < kOcclusionTaps.length(); ++i) {
    ivec2 tap = place + ivec2(round(turned(kOcclusionTaps[i], turn.x, turn.y)));
    sum += occlusionBy(positionAt(clamp(tap, ivec2(0), last)) - position, normal, uRadius);
  }
  oOpen = depth >= 1.0 ? 1.0 : openSky(sum, kOcclusionTaps.length(), uRadius);
}
