#include "camera.glsl"
#include "texel.glsl"

uniform float uChord;         // see wayThrough()
uniform float uFoamDepth;     // m; 0 for the sun
uniform sampler2D uFront, uBackground;
flat in vec4 vSphere;
flat in float vAlong;
layout(location = 0) out vec2 oThickness;

void main() {
  float drawn = max(vSphere.z, 1.0);
  vec2 aside = (gl_FragCoord.xy - vSphere.xy) / drawn;
  float rest = 1.0 - dot(aside, aside);
  if (rest < 0.0) discard;
  float spread = vSphere.z / drawn;
  float chord = wayThrough(rest, uChord, spread);
  float foam = vSphere.w;
  if (uFoamDepth > 0.0) {
    ivec2 place = ivec2(gl_FragCoord.xy);
    if (vAlong > texelFetch(uBackground, place, 0).r) discard;
    ivec2 under = texelUnder(place, textureSize(uBackground, 0), textureSize(uFront, 0));
    float front = distanceAt(texelFetch(uFront, under, 0).r);
    foam *= foamSeen(vAlong, front, uFoamDepth);
  }
  oThickness = vec2(chord, chord * foam);
}
