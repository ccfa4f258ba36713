// A rough surface bends some of the light to other places, the more the deeper the ground lies.
uniform sampler2D uThickness, uDepth;
uniform vec3 uExtinction;    // 1/m
uniform float uFoamOpacity;  // 1/m
uniform float uUneven;       // m
out vec4 oThrough;

void main() {
  ivec2 place = ivec2(gl_FragCoord.xy);
  ivec2 last = textureSize(uThickness, 0) - 1;
  vec2 sum = vec2(0.0);
  float weights = 0.0;
  for (int y = -1; y <= 1; ++y)
    for (int x = -1; x <= 1; ++x) {
      float weight = exp(-0.4 * float(x * x + y * y));
      sum += weight * texelFetch(uThickness, clamp(place + ivec2(x, y), ivec2(0), last), 0).rg;
      weights += weight;
    }
  vec2 thickness = max(sum / weights, 0.0);
  float bent = 0.45 * (1.0 - exp(-thickness.x / uUneven));
  oThrough = vec4(exp(-uExtinction * thickness.x - 0.35 * uFoamOpacity * thickness.y) * (1.0 - bent), 1.0);
  gl_FragDepth = texelFetch(uDepth, place, 0).r;
}
