// A small round of both axes together takes away the streaks that the axes leave one by one.
uniform sampler2D uNearness;
uniform float uRange;  // m
out float oNearness;

void main() {
  ivec2 place = ivec2(gl_FragCoord.xy);
  float here = texelFetch(uNearness, place, 0).r;
  oNearness = here;
  if (here <= 0.0) return;
  ivec2 last = textureSize(uNearness, 0) - 1;
  float sum = here, weights = 1.0;
  for (int y = -2; y <= 2; ++y)
    for (int x = -2; x <= 2; ++x) {
      if (x == 0 && y == 0) continue;
      float there = texelFetch(uNearness, clamp(place + ivec2(x, y), ivec2(0), last), 0).r;
      if (there <= 0.0) continue;
      float apart = (1.0 / there - 1.0 / here) / uRange;
      float weight = exp(-0.25 * float(x * x + y * y) - 2.0 * apart * apart);
      sum += weight * there;
      weights += weight;
    }
  oNearness = sum / weights;
}
