#include "words.glsl"
#include "formulas.glsl"

// The normal that storedNormal() has stored.
vec3 normalOf(vec2 stored) {
  vec2 p = stored * 2.0 - 1.0;
  float z = 1.0 - abs(p.x) - abs(p.y);
  return normalize(z < 0.0 ? vec3(folded(p.y, p.x), folded(p.x, p.y), z) : vec3(p, z));
}
