// Places in pairs, outwards. The range grows with what lies in it, so that slopes are not cut off. All limits
// are soft, or spray would become noise. Pairs are closer together in the middle, where the range begins to follow a
// slope: water at a flat angle falls behind by as much as that from one row to the next. And their gaps are of many widths:
// with one, rows that far apart are smoothed with each other alone, and are seen as combs.
uniform sampler2D uNearness;
uniform int uStepX;        // 1: along x, 0: along y
uniform float uWidth;      // of the widest Gaussian at a distance of 1 m, in pixels
uniform float uShare;      // of that, in this round
uniform float uRange;      // m
out float oNearness;

const int kPairs = 9;
const float kLargest = 60.0;  // pixels

// What lies behind the range counts as if it were a little behind the middle.
float drawnNear(float distance, float farthest, float behind) {
  return distance <= farthest ? distance : max(behind, 2.0 * farthest - distance);
}

void main() {
  ivec2 place = ivec2(gl_FragCoord.xy);
  float here = texelFetch(uNearness, place, 0).r;
  oNearness = here;
  if (here <= 0.0) return;
  ivec2 unit = ivec2(uStepX, 1 - uStepX);
  float width = uShare * min(uWidth * here, 0.5 * kLargest);
  float distance = 1.0 / here;
  float nearest = distance - uRange, farthest = distance + uRange;
  float behind = distance + 0.2 * uRange;
  float sum = here, weights = 1.0;
  ivec2 last = textureSize(uNearness, 0) - 1;
  for (int i = 1; i <= kPairs; ++i) {
    float outwards = float(i) / float(kPairs), gap = 3.0 * width / float(kPairs) * sqrt(outwards);
    int away = int(max(float(i), 2.0 * width * outwards * sqrt(outwards) + 0.5));
    float part = float(away) / width;
    float weight = max(1.0, gap) * exp(-0.5 * part * part);
    ivec2 one = place + away * unit, other = place - away * unit;
    // With one of a pair alone, or the rim's place in its stead, water would bend up towards the picture's rim.
    if (weight < 0.05 || any(greaterThan(one, last)) || any(lessThan(other, ivec2(0)))) break;
    float a = texelFetch(uNearness, one, 0).r, b = texelFetch(uNearness, other, 0).r;
    float da = abs(a) > 0.0 ? 1.0 / abs(a) : 1e9, db = abs(b) > 0.0 ? 1.0 / abs(b) : 1e9;
    float over = (nearest - min(da, db)) / uRange;  // both count less, or the middle would move
    weight *= 1.0 - smoothstep(0.0, 1.0, over);
    sum += weight * (1.0 / drawnNear(da, farthest, behind) + 1.0 / drawnNear(db, farthest, behind));
    weights += 2.0 * weight;
    if (over > 0.0) continue;
    nearest = min(nearest, min(da, db) - uRange);
    if (da <= farthest) farthest = max(farthest, da + uRange);
    if (db <= farthest) farthest = max(farthest, db + uRange);
  }
  oNearness = sum / weights;
}
