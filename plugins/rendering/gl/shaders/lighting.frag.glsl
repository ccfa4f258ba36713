#include "sunlight.glsl"
#include "camera.glsl"
#include "normal.glsl"
#include "environment.glsl"

uniform sampler2D uAlbedo, uNormal, uDepth, uOcclusion;
uniform vec3 uBackgroundTop, uBackgroundBottom;
uniform vec3 uGroundMiddle;   // in camera space
uniform float uGroundRadius;
uniform float uTiles;         // side of the ground's tiles, m
uniform mat3 uToWorld;        // from camera space to one in which y is up
uniform bool uUnlit, uTransparent;
out vec4 oLight;

#ifdef TILES
// How light the ground's tiles are, and the joints between them, which are as wide as a sample at least, and paler
// where they would be narrower. Where a sample and its neighbours lie follows from its ray alone: differences
// between fragments (fwidth) are of squares of two that drivers take as they like, and mean nothing at outlines.
float tiles(vec3 ray) {
  float falling = min(dot(ray, uUp), -1e-6);
  float away = dot(uGroundMiddle, uUp) / falling;
  vec2 place = (uToWorld * (ray * away - uGroundMiddle)).xz / uTiles;
  vec3 right = vec3(1.0, 0.0, 0.0) - ray * (uUp.x / falling), up = vec3(0.0, 1.0, 0.0) - ray * (uUp.y / falling);
  vec2 fine = uPixel * uTangent * (away / uTiles);
  fine = max(fine.x * abs((uToWorld * right).xz) + fine.y * abs((uToWorld * up).xz), 1e-6);  // a sample, in tiles
  vec2 width = max(vec2(0.012), fine);
  vec2 aside = abs(fract(place - 0.5) - 0.5);
  vec2 joint = (1.0 - smoothstep(width * 0.5, width * 0.5 + fine, aside)) * min(vec2(1.0), vec2(0.012) / fine);
  vec2 tile = floor(place);
  return mix(1.0, 0.86, mod(tile.x + tile.y, 2.0)) * (1.0 - 0.35 * max(joint.x, joint.y));
}
#endif

bool isMaterial(float alpha, float material) { return abs(alpha - material) < 0.1; }

void main() {
  ivec2 place = ivec2(gl_FragCoord.xy);
  vec2 window = gl_FragCoord.xy * uPixel * 0.5;
  vec3 ray = rayAt(gl_FragCoord.xy);
  float depth = texelFetch(uDepth, place, 0).r;
  vec4 surface = texelFetch(uAlbedo, place, 0);
  vec3 position = ray * distanceAt(depth);
  bool nothing = depth >= 1.0, ground = isMaterial(surface.a, kGround);
  bool particle = isMaterial(surface.a, kParticle), white = isMaterial(surface.a, kWhite);
  bool mesh = !(nothing || ground || particle || white);

  // Much of a picture is nothing but background, and little of the ground fades into it.
  float faded = nothing ? 1.0 : ground ? fadeOfGround(length(position - uGroundMiddle), uGroundRadius) : 0.0;
  vec3 background = vec3(0.0);
  if (faded > 0.0) {
#ifdef OUTSIDE
    background = environment(normalize(ray));
#else
    background = backgroundOf(window.y, uBackgroundBottom, uBackgroundTop);
#endif
    if (faded >= 1.0) {
      oLight = uTransparent ? vec4(0.0) : vec4(background, 1.0);
      return;
    }
  }

  vec3 normal = normalOf(texelFetch(uNormal, place, 0).rg);
  vec3 towardsEye = -normalize(position);
#ifdef TILES
  if (ground) surface.rgb *= tiles(ray);
#endif
  float open = textureLod(uOcclusion, window, 0.0).r;
  float facing = dot(normal, uSun);
  vec3 sun = vec3(0.0);
  if (facing >= 0.0 || white) sun = sunlight(position, normal, float(mesh), particle ? 0.5 : 1.0, true);
  vec3 sunColor = uSunColor * sun;
  vec3 diffuse = diffuseLight(skyLight(normal), open, sunColor, 1.0, max(facing, 0.0));
  if (white) diffuse = frothLight(skyLight(uUp), sunColor, 1.0);
  vec3 color = surface.rgb * diffuse;
  if (particle)
    color = withShine(color, surface.rgb, uSkyColor, open, sunColor, step(0.0, facing),
                      cosineOfHighlight(normal, towardsEye), dot(normal, towardsEye));
#ifdef METAL
  if (isMaterial(surface.a, kMetal)) {
#ifdef MIRRORS
    vec3 mirrored = environment(reflect(-towardsEye, normal));
#else
    vec3 mirrored = reflectedLight(reflect(-towardsEye, normal), 1.0);
#endif
    vec3 tint = mix(surface.rgb, vec3(1.0), fresnel(dot(normal, towardsEye), 0.0));
    color = 0.25 * color + tint * (0.85 * mirrored * mix(0.4, 1.0, open) +
                                   0.12 * sun * highlight(normal, towardsEye, 120.0) * step(0.0, facing));
  }
#endif
  if (uUnlit) color = surface.rgb;
  if (ground) color = mix(color, background, faded);
  oLight = vec4(color, 1.0);
  if (!uTransparent || !ground) return;
  // Of the ground, what it lacks of the light that it would have without the scene.
  vec3 lit = skyLight(normal) + uSunColor * max(facing, 0.0);
  float dark = clamp(1.0 - dot(diffuse, vec3(1.0)) / max(dot(lit, vec3(1.0)), 1e-6), 0.0, 1.0);
  oLight = vec4(vec3(0.0), uUnlit ? 0.0 : dark * (1.0 - faded));
}
