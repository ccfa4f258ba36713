#include "sphere_hit.glsl"

flat in vec4 vColor;  // and what it is made of
layout(location = 0) out vec4 oAlbedo;
layout(location = 1) out vec2 oNormal;

void main() {
  vec3 ray = rayAt(gl_FragCoord.xy);
  float distance = distanceOfHit(ray);
  vec3 normal = (ray * distance - vCenter) / uRadius;
  gl_FragDepth = depthAt(distance);
  oAlbedo = vColor;
  oNormal = storedNormal(normal);
}
