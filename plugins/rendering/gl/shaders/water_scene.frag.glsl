uniform sampler2D uLight;
uniform int uSamples;
out vec4 oLight;

void main() {
  ivec2 first = ivec2(gl_FragCoord.xy) * uSamples;
  vec4 sum = vec4(0.0);
  for (int y = 0; y < uSamples; ++y)
    for (int x = 0; x < uSamples; ++x) sum += texelFetch(uLight, first + ivec2(x, y), 0);
  oLight = sum / float(uSamples * uSamples);
}
