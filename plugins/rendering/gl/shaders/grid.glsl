// OpenGL rounds places in the window, at least to 1/16 of a sample, and leaves open whether what is
// interpolated over a triangle belongs to the places before or after that. So they are rounded here, to the
// 1/256 that drivers in use have: after that nothing is left to round.
uniform vec2 uGrid;  // steps in half the window: 128 times its size
vec4 onGrid(vec4 clip) {
  if (clip.z <= -clip.w) return clip;  // before the near plane
  return vec4(round(clip.xy / clip.w * uGrid) / uGrid * clip.w, clip.zw);
}
