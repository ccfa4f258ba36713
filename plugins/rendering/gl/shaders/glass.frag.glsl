// Two outputs for one target: the light that is added, and the part of the light behind that comes through.
#include "behind.glsl"
#include "environment.glsl"

uniform vec3 uTint;
uniform bool uUnlit, uOutside;
in vec3 vNormal;
in vec3 vPosition;
layout(location = 0, index = 0) out vec4 oAdded;
layout(location = 0, index = 1) out vec4 oThrough;

void main() {
  leaveUnlessBehind();
  vec3 towardsEye = -normalize(vPosition);
  vec3 normal = normalize(vNormal);
  if (!gl_FrontFacing) normal = -normal;
  float cosine = max(dot(normal, towardsEye), 0.0);
  float mirror = fresnel(cosine, 0.04);
  // The way through a thin wall is longer at a flat angle, where real glass bends in light from darker places too.
  vec3 through = pow(uTint, vec3(0.1 / max(cosine, 0.15))) * (1.0 - 0.45 * pow(1.0 - cosine, 3.0));
  vec3 surroundings = uOutside ? environment(reflect(-towardsEye, normal))
                               : reflectedLight(reflect(-towardsEye, normal), 2.6);
  vec3 mirrored = surroundings + 0.35 * uSunColor * highlight(normal, towardsEye, 300.0);
  float seen = gl_FrontFacing ? 1.0 : 0.45;  // inner sides mirror less: their light crosses the wall twice
  through *= 1.0 - mirror * seen;
  float clear = dot(through, vec3(1.0 / 3.0));
  oAdded = vec4(uUnlit ? vec3(0.0) : seen * mirror * mirrored, 1.0 - clear);
  oThrough = vec4(through, clear);
}
