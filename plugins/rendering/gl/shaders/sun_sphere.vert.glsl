// The nearest side of a sphere towards the sun, in the sun's clip space.
#include "corner.glsl"

uniform mat4 uToClip;
uniform float uRadiusInClip;
flat out float vDepth;
out vec2 vPlace;

void main() {
  vec4 center = uToClip * vec4(particle().xyz, 1.0);
  vPlace = 2.0 * corner() - 1.0;
  vDepth = center.z;
  gl_Position = vec4(center.xy + vPlace * uRadiusInClip, center.z, 1.0);
}
