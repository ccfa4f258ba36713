#include "words.glsl"
#include "formulas.glsl"

// The texel of a map of `size` that holds the middle of texel `place` of a map of size `own`.
ivec2 texelUnder(ivec2 place, ivec2 own, ivec2 size) {
  return ivec2(texelUnder(place.x, own.x, size.x), texelUnder(place.y, own.y, size.y));
}
