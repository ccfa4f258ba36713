#include "corner.glsl"

uniform mat4 uToClip;
uniform vec2 uSize;           // of the map, in texels
uniform float uRadius, uNear; // m
uniform float uTexels;        // of 1 m at a distance of 1 m
flat out vec4 vSphere;        // middle and radius in texels, distance in m, part of foam
flat out float vAlong;

void main() {
  vec4 data = particle();
  vec4 clip = uToClip * vec4(data.xyz, 1.0);
  float radius = uRadius * uTexels / clip.w;
  float drawn = max(radius, 1.0);
  vec2 middle = (0.5 + 0.5 * clip.xy / clip.w) * uSize;
  vSphere = vec4(middle, radius, data.w);
  vAlong = clip.w;
  vec2 place = (middle + drawn * (2.0 * corner() - 1.0)) / uSize * 2.0 - 1.0;
  gl_Position = clip.w < uNear ? vec4(0.0, 0.0, 2.0, 1.0) : vec4(place, 0.0, 1.0);
}
