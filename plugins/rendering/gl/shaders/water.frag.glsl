#include "sunlight.glsl"
#include "camera.glsl"
#include "environment.glsl"

uniform sampler2D uNearness, uNormal, uThickness, uScene, uLight, uAlbedo, uDepth;
uniform int uSamples;
uniform bool uUnlit;
uniform vec3 uAbsorption, uScattered;
uniform float uScattering, uFoamOpacity, uRefractiveIndex;
uniform float uSpacing;  // m, of the particles
out vec4 oLight;

vec3 pointAt(ivec2 place, float nearness) { return rayAt(vec2(place) + 0.5) / abs(nearness); }

// The difference to the neighbours, above all to that which is less far away.
vec3 slope(ivec2 place, ivec2 across, vec3 here) {
  float before = texelFetch(uNearness, place - across, 0).r, behind = texelFetch(uNearness, place + across, 0).r;
  vec3 a = here - pointAt(place - across, before), b = pointAt(place + across, behind) - here;
  if (before == 0.0) return behind == 0.0 ? vec3(across, 0.0) : b;
  if (behind == 0.0) return a;
  float step = here.z * uPixel.y * uTangent.y;
  vec2 weights = 1.0 / (vec2(a.z * a.z, b.z * b.z) + step * step);
  return (a * weights.x + b * weights.y) / (weights.x + weights.y);
}

vec3 normalOf(ivec2 place, float nearness, vec3 here) {
  if (nearness < 0.0) {
    ivec2 first = place * uSamples;
    vec3 sum = vec3(0.0);
    for (int y = 0; y < uSamples; ++y)
      for (int x = 0; x < uSamples; ++x) {
        vec4 normal = texelFetch(uNormal, first + ivec2(x, y), 0);
        sum += normal.a * (normal.xyz * 2.0 - 1.0);
      }
    return normalize(sum);
  }
  vec3 normal = normalize(cross(slope(place, ivec2(1, 0), here), slope(place, ivec2(0, 1), here)));
  return dot(normal, here) > 0.0 ? -normal : normal;
}

// Where a liquid meets a wall, spheres stand out of its surface before the wall, and their rims would be a pale fringe of
// scallops. A layer of particles reaches as far as their spacing from what it lies on; what reaches less far is such a
// rim.
float seenShare(float nearness, float gap) {
  return nearness < 0.0 ? 1.0 : smoothstep(0.1, 1.0, gap / max(uSpacing, 1e-6));
}

float opaqueDistance(ivec2 place) { return distanceAt(texelFetch(uDepth, place, 0).r); }

bool isWhite(ivec2 place) { return abs(texelFetch(uAlbedo, place, 0).a - kWhite) < 0.1; }

bool showsWhite(ivec2 place) {
  bool white = false;
  for (int y = 0; y < uSamples; ++y)
    for (int x = 0; x < uSamples; ++x) white = white || isWhite(place * uSamples + ivec2(x, y));
  return white;
}

// Drops and bubbles are smaller than what a liquid bends light by, and than a pixel: where bent light comes from there may
// be none, or from one of a pixel's samples. So white water is seen straight on, as the mean of the samples behind the
// liquid's front, each by its own way through it, which is `slant` times as long as it is deep. The gap behind the front
// becomes the largest of theirs.
void seeStraight(ivec2 place, float front, float slant, float thickness, vec3 extinction, inout float gap, inout vec3 light,
                 inout vec3 through) {
  vec3 lights = vec3(0.0), parts = vec3(0.0);
  float count = 0.0;
  for (int y = 0; y < uSamples; ++y)
    for (int x = 0; x < uSamples; ++x) {
      ivec2 at = place * uSamples + ivec2(x, y);
      float way = (opaqueDistance(at) - front) * slant;
      if (way <= 0.0) continue;
      gap = max(gap, way);
      vec3 part = exp(-extinction * min(thickness, way));
      lights += part * texelFetch(uLight, at, 0).rgb;
      parts += part;
      count += 1.0;
    }
  if (count > 0.0) light = lights / count, through = parts / count;
}

vec2 windowOf(vec3 position) { return 0.5 + 0.5 * position.xy / (-position.z * uTangent); }

void main() {
  ivec2 place = ivec2(gl_FragCoord.xy);
  float nearness = texelFetch(uNearness, place, 0).r;
  if (nearness == 0.0) discard;
  vec2 window = gl_FragCoord.xy * uPixel * 0.5;
  vec3 position = pointAt(place, nearness);
  vec3 towardsEye = -normalize(position);
  vec3 normal = normalOf(place, nearness, position);

  float front = -position.z, slant = length(position) / front;
  float gap = max(opaqueDistance(place * uSamples + uSamples / 2) - front, 0.0) * slant;
  vec2 thickness = max(texture(uThickness, window).rg, 0.0);
  float way = min(thickness.x, gap);
  vec3 bent = refract(-towardsEye, normal, 1.0 / uRefractiveIndex);
  vec2 seen = windowOf(position + bent * way);
  ivec2 samples = textureSize(uDepth, 0);
  ivec2 seenSample = clamp(ivec2(seen * vec2(samples)), ivec2(0), samples - 1);
  if (opaqueDistance(seenSample) < front || isWhite(seenSample) || seen != clamp(seen, 0.0, 1.0)) seen = window;
  vec4 scene = texture(uScene, seen);
  vec3 behind = scene.rgb;

  vec3 extinction = uAbsorption + uScattering;
  vec3 through = exp(-extinction * way), lightBehind = behind * through;
  if (showsWhite(place)) seeStraight(place, front, slant, thickness.x, extinction, gap, lightBehind, through);
  float seenThrough = dot(through, vec3(1.0 / 3.0));
  vec3 sun = sunlightOfPixel(position, normal);
  vec3 inside = skyLight(uUp) + 0.6 * uSunColor * sun;
  vec3 scattered = uScattered * uScattering / max(extinction, 1e-6) * (1.0 - through) * inside;
  vec3 refracted = lightBehind + scattered;
  float straight = (uRefractiveIndex - 1.0) / (uRefractiveIndex + 1.0);
  float mirror = fresnel(dot(normal, towardsEye), straight * straight);
  vec3 away = reflect(-towardsEye, normal);
  // Below the horizon a deep liquid mirrors more of itself, and not the ground that the surroundings have there.
  float ofItself = smoothstep(0.0, 0.22, -dot(away, uUp)) * (1.0 - seenThrough);
  vec3 mirrored = mix(environment(away), refracted, ofItself);
  vec3 color = mix(refracted, mirrored, mirror) + 0.03 * uSunColor * sun * highlight(normal, towardsEye, 400.0);
  float foam = 1.0 - exp(-uFoamOpacity * thickness.y);
  vec3 white = 0.93 * (skyLight(normal) + uSunColor * sun * max(dot(normal, uSun), 0.0));
  if (uUnlit) color = lightBehind, white = vec3(1.0);
  float clear = seenThrough * (1.0 - mirror);
  float covered = 1.0 - (1.0 - scene.a) * clear;
  vec4 liquid = vec4(mix(color, white, foam), mix(covered, 1.0, foam));
  oLight = mix(texture(uScene, window), liquid, seenShare(nearness, gap));
}
