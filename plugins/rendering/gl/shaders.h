// The shaders of the renderer, GLSL 3.30. The passes are described in renderer.h.
#pragma once

#include <string>

namespace weir::rendering::shaders {

/// A triangle that covers the picture.
inline constexpr const char* kFullScreenVertex = R"(#version 330 core
out vec2 uv;
void main() {
  uv = vec2((gl_VertexID << 1) & 2, gl_VertexID & 2);
  gl_Position = vec4(2.0 * uv - 1.0, 0.0, 1.0);
}
)";

/// A quad that exactly bounds a sphere's silhouette in perspective: the silhouette is a circle in the plane
/// through c·(1 − r²/|c|²), of radius r·sqrt(|c|² − r²)/|c|, for a centre c seen from the origin.
inline constexpr const char* kSphereVertex = R"(#version 330 core
layout(location = 0) in vec3 center;
layout(location = 1) in float shade;
uniform mat4 viewMatrix, projection;
uniform float radius;
uniform bool orthographic;
out vec3 position;
flat out vec3 viewCenter;
flat out float colorShade;
void main() {
  vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0;
  vec3 c = (viewMatrix * vec4(center, 1.0)).xyz;
  viewCenter = c;
  colorShade = shade;
  vec3 right = vec3(1, 0, 0), up = vec3(0, 1, 0);
  vec3 middle = c;
  float size = radius;
  if (!orthographic) {
    float d2 = dot(c, c), r2 = radius * radius;
    if (d2 <= 1.0001 * r2) {  // the eye is inside
      gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
      position = c;
      return;
    }
    vec3 towards = c * inversesqrt(d2);
    right = normalize(abs(towards.y) < 0.99 ? cross(towards, vec3(0, 1, 0)) : cross(towards, vec3(1, 0, 0)));
    up = cross(right, towards);
    middle = c * (1.0 - r2 / d2);
    size = radius * sqrt((d2 - r2) / d2);
  }
  position = middle + size * (corner.x * right + corner.y * up);
  gl_Position = projection * vec4(position, 1.0);
}
)";

inline constexpr const char* kSphereFragment = R"(#version 330 core
in vec3 position;
flat in vec3 viewCenter;
flat in float colorShade;
uniform mat4 projection;
uniform float radius;
uniform sampler2D colors;
layout(location = 0) out vec4 albedo;
layout(location = 1) out vec4 normal;
void main() {
  vec3 ray = normalize(position);
  float along = dot(ray, viewCenter);
  vec3 off = viewCenter - along * ray;
  float under = radius * radius - dot(off, off);
  if (under < 0.0) discard;
  vec3 hit = ray * (along - sqrt(under));
  normal = vec4((hit - viewCenter) / radius, 0.0);
  albedo = vec4(texture(colors, vec2(colorShade * (255.0 / 256.0) + 0.5 / 256.0, 0.5)).rgb, 0.75);
  vec2 clip = vec2(projection[2][2] * hit.z + projection[3][2], -hit.z);
  gl_FragDepth = 0.5 * clip.x / clip.y + 0.5;
}
)";

/// For the light, which looks along parallel rays.
inline constexpr const char* kSphereShadowFragment = R"(#version 330 core
in vec3 position;
flat in vec3 viewCenter;
flat in float colorShade;
uniform mat4 projection;
uniform float radius;
void main() {
  vec2 off = position.xy - viewCenter.xy;
  float under = radius * radius - dot(off, off);
  if (under < 0.0) discard;
  gl_FragDepth = 0.5 * (projection[2][2] * (viewCenter.z + sqrt(under)) + projection[3][2]) + 0.5;
}
)";

inline constexpr const char* kMeshVertex = R"(#version 330 core
layout(location = 0) in vec3 point;
layout(location = 1) in vec3 direction;
uniform mat4 viewMatrix, projection;
out vec3 position;
out vec3 viewNormal;
void main() {
  position = (viewMatrix * vec4(point, 1.0)).xyz;
  viewNormal = (viewMatrix * vec4(direction, 0.0)).xyz;
  gl_Position = projection * vec4(position, 1.0);
}
)";

/// `kind` is the material: 1 matt, 0.5 metal, 0.25 ground.
inline constexpr const char* kMeshFragment = R"(#version 330 core
in vec3 position;
in vec3 viewNormal;
uniform vec3 color;
uniform float kind;
layout(location = 0) out vec4 albedo;
layout(location = 1) out vec4 normal;
void main() {
  vec3 n = normalize(viewNormal);
  if (dot(n, position) > 0.0) n = -n;
  albedo = vec4(color, kind);
  normal = vec4(n, 0.0);
}
)";

inline constexpr const char* kShadowMeshFragment = R"(#version 330 core
void main() {}
)";

/// A line as a quad of a width in pixels.
inline constexpr const char* kLineVertex = R"(#version 330 core
layout(location = 0) in vec3 from;
layout(location = 1) in vec3 to;
uniform mat4 viewMatrix, projection;
uniform vec2 size;
uniform float width;
void main() {
  const float kNear = -0.02;
  vec4 a = viewMatrix * vec4(from, 1.0), b = viewMatrix * vec4(to, 1.0);
  if (a.z > kNear && b.z > kNear) {
    gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    return;
  }
  if (a.z > kNear) a = mix(b, a, (kNear - b.z) / (a.z - b.z));
  if (b.z > kNear) b = mix(a, b, (kNear - a.z) / (b.z - a.z));
  vec4 p = projection * a, q = projection * b;
  vec2 along = (q.xy / q.w - p.xy / p.w) * size;
  vec2 across = length(along) > 0.0 ? normalize(vec2(-along.y, along.x)) : vec2(1, 0);
  vec4 end = (gl_VertexID & 1) == 0 ? p : q;
  float side = (gl_VertexID >> 1) == 0 ? -1.0 : 1.0;
  end.xy += side * across * width / size * end.w;
  gl_Position = end;
}
)";

inline constexpr const char* kLineFragment = R"(#version 330 core
uniform vec4 color;
layout(location = 0) out vec4 result;
void main() { result = color; }
)";

/// Ambient occlusion: the share of points in a hemisphere over the surface that are not behind something.
inline constexpr const char* kOcclusionFragment = R"(#version 330 core
in vec2 uv;
uniform sampler2D depth, normals;
uniform mat4 projection;
uniform float reach;
layout(location = 0) out vec4 result;

vec3 viewAt(vec2 at) {
  float ndc = 2.0 * texture(depth, at).r - 1.0;
  float z = -projection[3][2] / (ndc + projection[2][2]);
  return vec3((2.0 * at - 1.0) * -z / vec2(projection[0][0], projection[1][1]), z);
}

void main() {
  if (texture(depth, uv).r == 1.0) {
    result = vec4(1.0);
    return;
  }
  const int kSamples = 14;
  vec3 p = viewAt(uv), n = texture(normals, uv).xyz;
  vec3 tangent = normalize(abs(n.z) < 0.9 ? cross(n, vec3(0, 0, 1)) : cross(n, vec3(1, 0, 0)));
  vec3 other = cross(n, tangent);
  // Interleaved gradient noise: turns the samples from pixel to pixel, and the blur removes it again.
  float noise = fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))));
  float open = 0.0;
  for (int k = 0; k < kSamples; ++k) {
    float share = (float(k) + 0.5) / float(kSamples);
    float angle = 6.2831853 * (noise + 0.381966 * float(k));
    float height = sqrt(1.0 - share);
    vec3 direction = sqrt(share) * (cos(angle) * tangent + sin(angle) * other) + height * n;
    float far = reach * (0.15 + 0.85 * fract(share * 5.0 + noise));
    vec3 probe = p + far * direction;
    vec4 clip = projection * vec4(probe, 1.0);
    vec3 hit = viewAt(clamp(0.5 * clip.xy / clip.w + 0.5, 0.0, 1.0));
    float front = hit.z - probe.z;  // how far the surface there stands before the probe
    bool hidden = front > 0.02 * reach && front < 2.0 * reach;
    open += hidden ? 0.0 : 1.0;
  }
  result = vec4(open / float(kSamples));
}
)";

/// Averages over the noise's pattern, but not across edges.
inline constexpr const char* kBlurFragment = R"(#version 330 core
in vec2 uv;
uniform sampler2D occlusion, depth;
uniform mat4 projection;
uniform vec2 pixel;
uniform float reach;
layout(location = 0) out vec4 result;
float distanceAt(vec2 at) { return projection[3][2] / (2.0 * texture(depth, at).r - 1.0 + projection[2][2]); }
void main() {
  float here = distanceAt(uv), sum = 0.0, weights = 1e-4;
  for (int y = -2; y <= 2; ++y)
    for (int x = -2; x <= 2; ++x) {
      vec2 at = uv + vec2(x, y) * pixel;
      float weight = abs(distanceAt(at) - here) < 0.5 * reach ? 1.0 : 0.0;
      sum += weight * texture(occlusion, at).r;
      weights += weight;
    }
  result = vec4(sum / weights);
}
)";

/// What all passes know of light and background. Colours are linear.
inline const std::string kLighting = R"(
uniform vec3 backgroundTop, backgroundBottom;
uniform vec3 sunDirection;  // towards the sun, in view space
uniform vec3 upDirection;   // in view space
vec3 linear(vec3 c) { return pow(c, vec3(2.2)); }
vec3 background(float height) { return mix(linear(backgroundBottom), linear(backgroundTop), smoothstep(0.0, 1.0, height)); }
const vec3 kSun = vec3(1.0, 0.96, 0.9) * 1.9;
vec3 ambient(vec3 n) {
  return mix(vec3(0.42, 0.40, 0.38), vec3(0.72, 0.80, 0.92), 0.5 + 0.5 * dot(n, upDirection)) * 0.62;
}
vec3 environment(vec3 d) {
  float height = dot(d, upDirection);
  vec3 sky = mix(vec3(0.85, 0.9, 0.95), vec3(0.45, 0.62, 0.88), clamp(height, 0.0, 1.0));
  vec3 floor = vec3(0.42, 0.41, 0.40);
  return mix(floor, sky, smoothstep(-0.08, 0.12, height));
}
float highlight(vec3 n, vec3 v, float power) {
  return pow(max(dot(n, normalize(v + sunDirection)), 0.0), power);
}
)";

inline const std::string kShadeFragment = std::string(R"(#version 330 core
in vec2 uv;
uniform sampler2D albedos, normals, depth, occlusion, shadow;
uniform mat4 projection, toLight;  // toLight: from view space
uniform float texel, bias, groundReach;
uniform vec3 focus;  // in view space
layout(location = 0) out vec4 result;
)") + kLighting + R"(
float lit(vec3 p, vec3 n) {
  vec3 at = 0.5 * (toLight * vec4(p + n * bias, 1.0)).xyz + 0.5;
  if (any(lessThan(at, vec3(0.0))) || any(greaterThan(at, vec3(1.0)))) return 1.0;
  float noise = 6.2831853 * fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))));
  const int kTaps = 6;
  float sum = 0.0;
  for (int k = 0; k < kTaps; ++k) {
    float angle = noise + 2.3999632 * float(k);
    vec2 off = sqrt((float(k) + 0.5) / float(kTaps)) * vec2(cos(angle), sin(angle)) * texel * 4.0;
    sum += texture(shadow, at.xy + off).r + 1e-4 < at.z ? 0.0 : 1.0;
  }
  return sum / float(kTaps);
}
void main() {
  float d = texture(depth, uv).r;
  vec3 behind = background(uv.y);
  if (d == 1.0) {
    result = vec4(behind, 1.0);
    return;
  }
  float z = -projection[3][2] / (2.0 * d - 1.0 + projection[2][2]);
  vec3 p = vec3((2.0 * uv - 1.0) * -z / vec2(projection[0][0], projection[1][1]), z);
  vec4 albedo = texture(albedos, uv);
  vec3 base = linear(albedo.rgb), n = texture(normals, uv).xyz, v = normalize(-p);
  float open = texture(occlusion, uv).r;
  open = mix(0.25, 1.0, open * open);
  float facing = max(dot(n, sunDirection), 0.0);
  float sun = facing > 0.0 ? lit(p, n) : 0.0;
  vec3 color = base * (ambient(n) * open + kSun * facing * sun * 0.55);
  if (albedo.a > 0.6 && albedo.a < 0.9) {  // wet spheres
    float fresnel = 0.04 + 0.5 * pow(1.0 - max(dot(n, v), 0.0), 5.0);
    color += environment(reflect(-v, n)) * fresnel * open * 0.5 + kSun * highlight(n, v, 60.0) * 0.16 * sun;
  } else if (albedo.a > 0.4 && albedo.a < 0.6) {  // metal
    color = color * 0.35 + base * (environment(reflect(-v, n)) * open + kSun * highlight(n, v, 90.0) * sun);
  } else if (albedo.a < 0.4) {  // ground: fades into the background
    color = mix(color, behind, smoothstep(0.25, 1.0, length(p - focus) / groundReach));
  }
  result = vec4(color, 1.0);
}
)";

/// A thin dielectric shell: reflects by Fresnel's law (Schlick), absorbs a little, more where seen at a
/// slant.
inline const std::string kGlassFragment = std::string(R"(#version 330 core
in vec3 position;
in vec3 viewNormal;
uniform vec3 color;
uniform float opacity;
layout(location = 0) out vec4 result;
)") + kLighting + R"(
void main() {
  vec3 v = normalize(-position), n = normalize(viewNormal);
  if (dot(n, v) < 0.0) n = -n;
  float slant = clamp(dot(n, v), 0.02, 1.0);
  float fresnel = 0.04 + 0.96 * pow(1.0 - slant, 5.0);
  float absorbed = 1.0 - pow(1.0 - opacity, min(1.0 / slant, 6.0));
  vec3 light = environment(reflect(-v, n)) * fresnel + kSun * highlight(n, v, 350.0) * 0.9;
  vec3 tint = linear(color) * (ambient(n) + 0.2) * absorbed;
  float alpha = 1.0 - (1.0 - fresnel) * (1.0 - absorbed);
  result = vec4(light + tint, alpha);  // premultiplied
}
)";

/// Averages 2 × 2 samples, then maps light to the screen.
inline constexpr const char* kResolveFragment = R"(#version 330 core
in vec2 uv;
uniform sampler2D light;
uniform vec2 pixel;  // of the light's texture
layout(location = 0) out vec4 result;
// Leaves the lower part as it is, so that colours stay true to the colour bar, and bends the rest towards white.
vec3 shown(vec3 c) {
  const float kKnee = 0.8;
  vec3 above = max(c - kKnee, 0.0);
  return min(c, kKnee) + (1.0 - kKnee) * above / (above + (1.0 - kKnee));
}
void main() {
  vec3 sum = vec3(0.0);
  for (int k = 0; k < 4; ++k)
    sum += shown(texture(light, uv + (vec2(k & 1, k >> 1) - 0.5) * pixel).rgb);
  vec3 c = sum / 4.0;
  result = vec4(mix(12.92 * c, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, c)), 1.0);
}
)";

}  // namespace weir::rendering::shaders
