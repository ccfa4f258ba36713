#include "light.glsl"

// What surrounds the scene, in a direction in camera space.
uniform sampler2D uSurroundings;  // all directions: around, and from below to above
uniform mat3 uToSurroundings;     // from camera space
uniform bool uAllAround;          // they have a lower half of their own

// The lower half is the ground and what it fades into.
vec3 environment(vec3 direction) {
  vec3 d = uToSurroundings * direction;
  vec2 place = vec2(atan(d.x, d.z) * 0.15915494 + 0.5, asin(clamp(d.y, -1.0, 1.0)) * 0.31830989 + 0.5);
  if (uAllAround) return textureLod(uSurroundings, place, 0.0).rgb;
  vec3 above = textureLod(uSurroundings, vec2(place.x, max(place.y, 0.503)), 0.0).rgb;
  vec3 lit = uGroundColor * (skyLight(uUp) + uSunColor * max(dot(uUp, uSun), 0.0));
  return mix(above, 0.8 * lit, smoothstep(0.0, 0.22, -d.y));
}
