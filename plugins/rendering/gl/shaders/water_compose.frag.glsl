uniform sampler2D uShaded, uDepth;
uniform int uSamples;
out vec4 oLight;

void main() {
  float depth = texelFetch(uDepth, ivec2(gl_FragCoord.xy), 0).r;
  if (depth >= 1.0) discard;
  oLight = texelFetch(uShaded, ivec2(gl_FragCoord.xy) / uSamples, 0);
  gl_FragDepth = depth;
}
