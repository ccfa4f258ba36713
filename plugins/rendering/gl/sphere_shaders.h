// Shaders that draw spheres with exact outlines: a rectangle around each sphere's picture, and a ray per
// sample.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "plugins/rendering/gl/shaders.h"

namespace weir::rendering::gl {

/// Vertex 4i + k is corner k of particle i; the indices make two triangles of the four corners.
inline const std::string kCornerSnippet = R"(
uniform samplerBuffer uCenters;
vec4 particle() { return texelFetch(uCenters, gl_VertexID >> 2); }
vec2 corner() { return vec2(gl_VertexID & 1, (gl_VertexID >> 1) & 1); }
)";

/// Two triangles for each four corners.
std::vector<std::uint32_t> cornerIndices(int particles);

/// Outputs vCenter, in camera space, and vColor.
/// The rectangle around a sphere's picture: per axis, the two lines through the eye that touch the sphere's
/// circle in the plane of that axis and the viewing axis (M. Mara, M. McGuire 2013).
inline const std::string kSphereVertexShader = kShaderVersion + kCornerSnippet + R"(
uniform mat4 uView;
uniform vec2 uTangent;
uniform float uRadius, uNear;
uniform sampler2D uColors;
flat out vec3 vCenter;
flat out vec3 vColor;

vec2 touchingLines(float across, float along) {
  float touch = sqrt(across * across + along * along - uRadius * uRadius);
  return vec2((across * touch - along * uRadius) / (along * touch + across * uRadius),
              (across * touch + along * uRadius) / (along * touch - across * uRadius));
}

void main() {
  vec4 data = particle();
  vCenter = (uView * vec4(data.xyz, 1.0)).xyz;
  vColor = textureLod(uColors, vec2(data.w, 0.5), 0.0).rgb;
  float along = -vCenter.z;
  if (along + uRadius < uNear) {  // behind the camera
    gl_Position = vec4(0.0, 0.0, 2.0, 1.0);
    return;
  }
  vec2 low = vec2(-1.0), high = vec2(1.0);
  if (along - uRadius > uNear) {  // otherwise it may fill the picture
    vec2 x = touchingLines(vCenter.x, along) / uTangent.x;
    vec2 y = touchingLines(vCenter.y, along) / uTangent.y;
    low = vec2(x.x, y.x);
    high = vec2(x.y, y.y);
  }
  gl_Position = vec4(mix(low, high, corner()), 0.0, 1.0);
}
)";

/// Where the ray of a sample meets the sphere; leaves samples that miss it. Needs kCameraSnippet.
inline const std::string kSphereHitSnippet = R"(
uniform float uRadius, uNear;
flat in vec3 vCenter;

// The distance along the camera's axis.
float distanceOfSphere(vec3 ray) {
  // From the point of the ray that is nearest to the centre: exact also for small spheres far away.
  float scale = 1.0 / dot(ray, ray);
  float middle = dot(ray, vCenter) * scale;
  vec3 aside = ray * middle - vCenter;
  float rest = uRadius * uRadius - dot(aside, aside);
  float distance = middle - sqrt(max(rest, 0.0) * scale);
  if (rest < 0.0 || distance < uNear) discard;
  return distance;
}
)";

/// The nearest side of a sphere towards the sun, in the sun's clip space.
inline const std::string kSunSphereVertexShader = kShaderVersion + kCornerSnippet + R"(
uniform mat4 uToClip;
uniform float uHalfSize, uRadius;
flat out float vDepth;
out vec2 vPlace;

void main() {
  vec4 center = uToClip * vec4(particle().xyz, 1.0);
  vPlace = 2.0 * corner() - 1.0;
  vDepth = center.z;
  gl_Position = vec4(center.xy + vPlace * (uRadius / uHalfSize), center.z, 1.0);
}
)";

inline const std::string kSunSphereFragmentShader = kShaderVersion + R"(
uniform float uRadiusInDepth;
flat in float vDepth;
in vec2 vPlace;

void main() {
  float rest = 1.0 - dot(vPlace, vPlace);
  if (rest < 0.0) discard;
  gl_FragDepth = 0.5 + 0.5 * (vDepth - uRadiusInDepth * sqrt(rest));
}
)";

}  // namespace weir::rendering::gl
