#include "camera.glsl"

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
