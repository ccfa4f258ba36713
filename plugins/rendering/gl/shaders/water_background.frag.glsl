#include "camera.glsl"
#include "texel.glsl"

// The farthest of the corners of each texel: a drop or a bubble in one of them must not hide the liquid behind it from
// the others, and how far light goes before what is in the way is known for each pixel.
uniform sampler2D uDepth;
uniform ivec2 uSize;  // of the map
out float oDistance;

void main() {
  ivec2 size = textureSize(uDepth, 0), reach = size / (2 * uSize);
  ivec2 middle = texelUnder(ivec2(gl_FragCoord.xy), uSize, size);
  float depth = 0.0;
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 2; ++x) {
      ivec2 corner = middle - reach + ivec2(x, y) * (2 * reach - 1);
      depth = max(depth, texelFetch(uDepth, clamp(corner, ivec2(0), size - 1), 0).r);
    }
  oDistance = depth < 1.0 ? distanceAt(depth) : 1e30;
}
