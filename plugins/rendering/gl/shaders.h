// Pieces of shader source that several passes share.
#pragma once

#include <string>

#include "framework/base/vec.h"

namespace weir::rendering::gl {

inline const std::string kShaderVersion = "#version 330 core\n";

/// "const vec2 NAME[N] = vec2[](…);": `count` places in the unit circle, which `placeOf` gives by number.
/// Constant places cost no sines in the shader.
std::string placesInCircle(const std::string& name, int count, Vec2f (*placeOf)(int number, int count));

/// Covers the whole picture with one triangle; to be drawn with drawArrays(GL_TRIANGLES, 0, 3).
inline const std::string kFullScreenVertexShader = kShaderVersion + R"(
void main() {
  gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0);
}
)";

/// OpenGL rounds places in the window, at least to 1/16 of a sample, and leaves open whether what is
/// interpolated over a triangle belongs to the places before or after that. So they are rounded here, to the
/// 1/256 that drivers in use have: after that nothing is left to round.
inline const std::string kGridSnippet = R"(
uniform vec2 uGrid;  // steps in half the window: 128 times its size
vec4 onGrid(vec4 clip) {
  if (clip.z <= -clip.w) return clip;  // before the near plane
  return vec4(round(clip.xy / clip.w * uGrid) / uGrid * clip.w, clip.zw);
}
)";

/// Triangles with normals, opaque or of glass.
inline const std::string kSurfaceVertexShader = kShaderVersion + kGridSnippet + R"(
layout(location = 0) in vec3 iPosition;
layout(location = 1) in vec3 iNormal;
uniform mat4 uToView;
uniform mat3 uNormalToView;
uniform mat4 uToClip;
out vec3 vNormal;
out vec3 vPosition;

void main() {
  vec4 position = uToView * vec4(iPosition, 1.0);
  vPosition = position.xyz;
  vNormal = uNormalToView * iNormal;
  gl_Position = onGrid(uToClip * position);
}
)";

/// Between depth-buffer values and distances along the camera's axis. See setCameraUniforms.
inline const std::string kCameraSnippet = R"(
uniform vec4 uProjection;  // P00, P11, P22, P23
uniform vec2 uTangent;     // of half the field of view
uniform vec2 uPixel;       // 2 / size of the picture

float depthAt(float distance) { return 0.5 + 0.5 * (uProjection.w / distance - uProjection.z); }
float distanceAt(float depth) { return uProjection.w / (2.0 * depth - 1.0 + uProjection.z); }
// The ray through a place in window coordinates, of length 1 along the camera's axis.
vec3 rayAt(vec2 window) { return vec3((window * uPixel - 1.0) * uTangent, -1.0); }
)";

/// Draws only what lies behind a depth: one texel for all, or one per sample. See setBehindUniforms.
inline const std::string kBehindSnippet = R"(
uniform sampler2D uBefore;
uniform vec2 uSampleSize;  // in texture coordinates
void leaveUnlessBehind() {
  if (gl_FragCoord.z < texture(uBefore, gl_FragCoord.xy * uSampleSize).r) discard;
}
)";

/// Maps of other sizes over the same picture. By integers, because middles of texels often lie on edges of
/// the other map's, where rounding would choose one. Products stay below 2^31 for sizes up to 32768.
inline const std::string kTexelSnippet = R"(
// The texel of a map of `size` that holds the middle of texel `place` of a map of size `own`.
ivec2 texelUnder(ivec2 place, ivec2 own, ivec2 size) { return (2 * place + 1) * size / (2 * own); }
)";

/// Normals in two numbers: places on the octahedron |x| + |y| + |z| = 1, whose far half is folded outwards
/// (Q. Meyer et al. 2010). With 16 bits each they are exact to 3e-5, in the memory of three times 10 bits.
inline const std::string kNormalSnippet = R"(
vec2 folded(vec2 p) { return (1.0 - abs(p.yx)) * vec2(p.x < 0.0 ? -1.0 : 1.0, p.y < 0.0 ? -1.0 : 1.0); }
vec2 storedNormal(vec3 n) {
  vec2 p = n.xy / (abs(n.x) + abs(n.y) + abs(n.z));
  return 0.5 + 0.5 * (n.z < 0.0 ? folded(p) : p);
}
vec3 normalOf(vec2 stored) {
  vec2 p = stored * 2.0 - 1.0;
  float z = 1.0 - abs(p.x) - abs(p.y);
  return normalize(vec3(z < 0.0 ? folded(p) : p, z));
}
)";

/// What surfaces are made of, in the alpha channel of their colour.
inline const std::string kMaterialSnippet = R"(
const float kMatt = 0.25, kParticle = 0.5, kMetal = 0.75, kGround = 1.0;
bool isMaterial(float alpha, float material) { return abs(alpha - material) < 0.1; }
)";

/// The light: a sun, a sky that is bright above and takes the ground's colour below, and soft lamps beside
/// the camera that only show in reflections. All directions are in camera space. See setLightUniforms.
inline const std::string kLightSnippet = R"(
uniform vec3 uSun;         // towards it
uniform vec3 uUp;
uniform vec3 uSkyColor;
uniform vec3 uGroundColor;

uniform vec3 uSunColor;
uniform float uSkyStrength;

uniform bool uImageLight;  // light from all sides is that of a picture, as forms of the normal
uniform mat4 uSkyRed, uSkyGreen, uSkyBlue;

vec3 skyLight(vec3 normal) {
  if (uImageLight) {
    vec4 n = vec4(normal, 1.0);
    return max(vec3(dot(n, uSkyRed * n), dot(n, uSkyGreen * n), dot(n, uSkyBlue * n)), 0.0);
  }
  float above = 0.5 + 0.5 * dot(normal, uUp);
  return uSkyStrength * mix(0.62 * uGroundColor, uSkyColor, above * (2.0 - above));
}

float lamp(vec3 direction, vec3 towards, vec3 across, vec2 size) {
  vec3 up = cross(towards, across);
  float facing = dot(direction, towards);
  if (facing <= 0.0) return 0.0;
  vec2 place = abs(vec2(dot(direction, across), dot(direction, up))) / facing;
  vec2 inside = 1.0 - smoothstep(size * 0.8, size * 1.2, place);
  return inside.x * inside.y;
}

vec3 reflectedLight(vec3 direction, float lampStrength) {
  float above = dot(direction, uUp);
  vec3 light = mix(0.42 * uGroundColor, 0.75 * uSkyColor, smoothstep(-0.35, 0.35, above));
  float lamps = 3.4 * lamp(direction, normalize(vec3(-0.75, 0.45, 0.5)), normalize(vec3(0.5, 0.0, 0.75)), vec2(0.28, 0.75));
  lamps += 2.0 * lamp(direction, normalize(vec3(0.9, 0.15, 0.35)), normalize(vec3(-0.35, 0.0, 0.9)), vec2(0.16, 0.9));
  return light + lampStrength * lamps;
}

// The normalised Blinn-Phong highlight (J. Blinn 1977), with F. Giesen's factor (n + 8) / 8.
float highlight(vec3 normal, vec3 towardsEye, float exponent) {
  float cosine = max(dot(normal, normalize(towardsEye + uSun)), 0.0);
  return (exponent + 8.0) / 8.0 * pow(cosine, exponent);
}

// C. Schlick's approximation (1994) of the reflected part.
float fresnel(float cosine, float straight) {
  float slant = 1.0 - clamp(cosine, 0.0, 1.0);
  float square = slant * slant;
  return straight + (1.0 - straight) * square * square * slant;
}
)";

}  // namespace weir::rendering::gl
