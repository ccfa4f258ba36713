#include "words.glsl"
#include "formulas.glsl"
#include "patterns.glsl"

// Each sample looks at four places of the shadow map, turned by another angle in each of four neighbouring
// samples, so that a pixel of 2x2 samples sees sixteen. What is lit once for a pixel looks at all of them.
uniform sampler2DShadow uShadow;
uniform sampler2D uThroughGlass;
uniform sampler2DShadow uWaterDepth;
uniform sampler2D uThroughWater;
uniform mat4 uToSun;        // from camera space to the shadow map
uniform mat3 uSlopeToSun;   // turns normals so that a plane's depth in the shadow map grows by xy / z along it
uniform float uSoftness;    // radius of the edges, in the shadow map's coordinates
uniform float uShadowTexel; // m

// The edges are wider than kShadowOffset, so a plane that the sun grazes would shade itself in stripes, unless each
// place is compared with the plane's depth there (J. Isidoro 2006). `flatness` is 1 for that, and 0 for what is curved
// within the edges' width, as particles are, or casts no shadow. Slopes end at 83 degrees, as light nearly does there.
vec2 slopeTowardsSun(vec3 normal, float flatness) {
  vec3 n = uSlopeToSun * normal;
  return n.xy * (flatness / max(n.z, 0.12));
}

vec3 turnedSunlight(vec3 position, vec3 normal, float flatness, float throughGlass, bool underWater, vec2 unitTurn) {
#ifdef SHADOWS
  vec4 place = uToSun * vec4(position + normal * uShadowTexel * kShadowOffset, 1.0);
  place.z = min(place.z, 1.0);
  vec2 slope = slopeTowardsSun(normal, flatness);
  vec2 turn = uSoftness * unitTurn;
  float open = 0.0;
  for (int i = 0; i < 4; ++i) {
    vec2 tap = turned(kShadowTaps[i], turn.x, turn.y);
    open += 0.25 * textureLod(uShadow, place.xyz + vec3(tap, dot(slope, tap)), 0.0);
  }
  vec3 light = vec3(open);
#ifdef GLASS
  light *= mix(vec3(1.0), textureLod(uThroughGlass, place.xy + 0.7 * turn, 0.0).rgb, throughGlass);
#endif
#ifdef WATER
  if (underWater) {
    float above = textureLod(uWaterDepth, place.xyz + vec3(0.7 * turn, 0.0), 0.0);
    light *= mix(textureLod(uThroughWater, place.xy + 0.7 * turn, 0.0).rgb, vec3(1.0), above);
  }
#endif
  return light;
#else
  return vec3(1.0);
#endif
}

vec3 sunlight(vec3 position, vec3 normal, float flatness, float throughGlass, bool underWater) {
  ivec2 odd = ivec2(gl_FragCoord.xy) & 1;
  return turnedSunlight(position, normal, flatness, throughGlass, underWater, kShadowTurns[odd.x + 2 * odd.y]);
}

vec3 sunlightOfPixel(vec3 position, vec3 normal) {
  vec3 sum = vec3(0.0);
  for (int i = 0; i < kShadowTurns.length(); ++i)
    sum += turnedSunlight(position, normal, 0.0, 1.0, false, kShadowTurns[i]);
  return sum / float(kShadowTurns.length());
}
