#include "camera.glsl"
#include "texel.glsl"

uniform sampler2D uDepth;
uniform ivec2 uSize;  // of the map
out float oDistance;

void main() {
  float depth = texelFetch(uDepth, texelUnder(ivec2(gl_FragCoord.xy), uSize, textureSize(uDepth, 0)), 0).r;
  oDistance = depth < 1.0 ? distanceAt(depth) : 1e30;
}
