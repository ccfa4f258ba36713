#include "words.glsl"
#include "formulas.glsl"

// The camera of the picture. See setCameraUniforms.
uniform vec4 uProjection;  // P00, P11, P22, P23
uniform vec2 uTangent;     // of half the field of view
uniform vec2 uPixel;       // 2 / size of the picture

float depthAt(float distance) { return depthOf(distance, uProjection); }
float distanceAt(float depth) { return distanceOf(depth, uProjection); }
vec3 rayAt(vec2 window) { return rayThrough(window.x, window.y, uPixel, uTangent); }
