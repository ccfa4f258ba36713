#include "sphere_hit.glsl"

uniform float uInset;  // m
layout(location = 0) out vec4 oNormal;

void main() {
  gl_FragDepth = depthAt(distanceOfHit(rayAt(gl_FragCoord.xy)) + uInset);
  oNormal = vec4(0.0);  // is found later
}
