#include "sphere_hit.glsl"

flat in vec3 vColor;
layout(location = 0) out vec4 oAlbedo;
layout(location = 1) out vec2 oNormal;

void main() {
  vec3 ray = rayAt(gl_FragCoord.xy);
  float distance = distanceOfHit(ray);
  vec3 normal = (ray * distance - vCenter) / uRadius;
  gl_FragDepth = depthAt(distance);
  oAlbedo = vec4(vColor, kParticle);
  oNormal = storedNormal(normal);
}
