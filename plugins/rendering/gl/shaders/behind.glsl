// Draws only what lies behind a depth: one texel for all, or one per sample. See setBehindUniforms.
uniform sampler2D uBefore;
uniform vec2 uSampleSize;  // in texture coordinates
void leaveUnlessBehind() {
  if (gl_FragCoord.z < texture(uBefore, gl_FragCoord.xy * uSampleSize).r) discard;
}
