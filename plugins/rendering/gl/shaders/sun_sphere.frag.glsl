#include "words.glsl"
#include "formulas.glsl"

uniform float uRadiusInDepth;
flat in float vDepth;
in vec2 vPlace;

void main() {
  float rest = 1.0 - dot(vPlace, vPlace);
  if (rest < 0.0) discard;
  gl_FragDepth = depthFromSun(rest, vDepth, uRadiusInDepth);
}
