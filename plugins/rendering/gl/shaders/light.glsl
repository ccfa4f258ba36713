#include "words.glsl"
#include "formulas.glsl"

// The light: a sun, a sky that is bright above and takes the ground's colour below, and soft lamps beside
// the camera that only show in reflections. All directions are in camera space. See setLightUniforms.
uniform vec3 uSun;         // towards it
uniform vec3 uUp;
uniform vec3 uSunColor;
uniform vec3 uSkyColor, uGroundColor;
uniform vec3 uSkyAbove, uSkyBelow;  // light from there

uniform bool uImageLight;  // light from all sides is that of a picture, as forms of the normal
uniform mat4 uSkyRed, uSkyGreen, uSkyBlue;

vec3 skyLight(vec3 normal) {
  if (uImageLight) {
    vec4 n = vec4(normal, 1.0);
    return max(vec3(dot(n, uSkyRed * n), dot(n, uSkyGreen * n), dot(n, uSkyBlue * n)), 0.0);
  }
  return skyLightOf(normal, uUp, uSkyBelow, uSkyAbove);
}

float lamp(vec3 direction, vec3 towards, vec3 across, vec2 size) {
  vec3 up = cross(towards, across);
  float facing = dot(direction, towards);
  if (facing <= 0.0) return 0.0;
  vec2 place = abs(vec2(dot(direction, across), dot(direction, up))) / facing;
  vec2 inside = 1.0 - smoothstep(size * 0.8, size * 1.2, place);
  return inside.x * inside.y;
}

vec3 reflectedLight(vec3 direction, float lampStrength) {
  float above = dot(direction, uUp);
  vec3 light = mix(0.42 * uGroundColor, 0.75 * uSkyColor, smoothstep(-0.35, 0.35, above));
  float lamps = 3.4 * lamp(direction, normalize(vec3(-0.75, 0.45, 0.5)), normalize(vec3(0.5, 0.0, 0.75)), vec2(0.28, 0.75));
  lamps += 2.0 * lamp(direction, normalize(vec3(0.9, 0.15, 0.35)), normalize(vec3(-0.35, 0.0, 0.9)), vec2(0.16, 0.9));
  return light + lampStrength * lamps;
}

// The normalised Blinn-Phong highlight (J. Blinn 1977), with F. Giesen's factor (n + 8) / 8.
float cosineOfHighlight(vec3 normal, vec3 towardsEye) {
  return max(dot(normal, normalize(towardsEye + uSun)), 0.0);
}
float highlight(vec3 normal, vec3 towardsEye, float exponent) {
  float cosine = cosineOfHighlight(normal, towardsEye);
  return (exponent + 8.0) / 8.0 * pow(cosine, exponent);
}
