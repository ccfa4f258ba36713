#include "words.glsl"
#include "formulas.glsl"

uniform sampler2D uLight;
uniform int uSamples, uHeight;
uniform bool uUnlit, uFilmic;
uniform float uExposure;
out vec4 oColor;  // not multiplied with its opacity

// Much light needs no shoulder.
vec3 shoulder(vec3 light) {
  if (max(light.r, max(light.g, light.b)) <= kKnee) return light;
  return vec3(shoulder(light.r), shoulder(light.g), shoulder(light.b));
}

// The curve that K. Narkowicz (2015) fitted to the film tones of ACES.
vec3 filmic(vec3 light) {
  return clamp(light * (2.51 * light + 0.03) / (light * (2.43 * light + 0.59) + 0.14), 0.0, 1.0);
}

vec3 toned(vec3 light) {
  if (uUnlit) return min(light, 1.0);
  light *= uExposure;
  return uFilmic ? filmic(0.8 * light) : shoulder(light);
}

vec3 encoded(vec3 light) { return vec3(encoded(light.r), encoded(light.g), encoded(light.b)); }

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.x, uHeight - 1 - int(gl_FragCoord.y));
  vec4 sum = vec4(0.0);
  for (int y = 0; y < uSamples; ++y)
    for (int x = 0; x < uSamples; ++x) {
      vec4 light = texelFetch(uLight, pixel * uSamples + ivec2(x, y), 0);
      vec3 color = toned(light.rgb);
      // Light that clear things add must be seen on any background.
      sum += vec4(color, max(light.a, max(color.r, max(color.g, color.b))));
    }
  sum.a = min(sum.a, float(uSamples * uSamples));
  oColor = vec4(encoded(sum.rgb / max(sum.a, 1e-6)), sum.a / float(uSamples * uSamples));
}
