// Light in the units of the scene, in which white paper in the sun is about 1.
uniform vec3 uTowardsSun;  // y is up
uniform bool uSky;
out vec4 oLight;

float hash(vec2 p) {
  vec3 q = fract(vec3(p.xyx) * 0.1031);
  q += dot(q, q.yzx + 33.33);
  return fract((q.x + q.y) * q.z);
}

float noise(vec2 p) {
  vec2 cell = floor(p), part = fract(p);
  part = part * part * (3.0 - 2.0 * part);
  return mix(mix(hash(cell), hash(cell + vec2(1.0, 0.0)), part.x),
             mix(hash(cell + vec2(0.0, 1.0)), hash(cell + vec2(1.0, 1.0)), part.x), part.y);
}

// Noise of several sizes, each turned against the one before.
float roughness(vec2 p) {
  float sum = 0.0, share = 0.5;
  for (int i = 0; i < 6; ++i) {
    sum += share * noise(p);
    p = mat2(1.6, 1.2, -1.2, 1.6) * p;
    share *= 0.5;
  }
  return sum;
}

vec3 sky(vec3 d) {
  float height = max(d.y, 0.0);
  float towards = max(dot(d, uTowardsSun), 0.0);
  vec3 light = mix(vec3(0.06, 0.19, 0.52), vec3(0.58, 0.75, 0.93), exp(-3.0 * height));
  light += vec3(1.0, 0.86, 0.66) * (0.22 * pow(towards, 6.0) + 1.2 * pow(towards, 160.0));
  vec2 place = 1.7 * d.xz / (height + 0.12) + vec2(3.1, 7.7);
  float cloud = smoothstep(0.47, 0.80, roughness(place)) * smoothstep(0.03, 0.30, height);
  float thick = roughness(place + 0.18 * uTowardsSun.xz);
  vec3 white = mix(vec3(1.12, 1.09, 1.05), vec3(0.62, 0.68, 0.76), smoothstep(0.4, 0.85, thick));
  return mix(light, white, 0.9 * cloud);
}

float box(vec3 d, vec3 towards, vec3 across, vec2 size) {
  float facing = dot(d, towards);
  vec3 up = cross(towards, across);
  vec2 place = abs(vec2(dot(d, across), dot(d, up))) / max(facing, 1e-3);
  vec2 inside = 1.0 - smoothstep(size * 0.75, size * 1.25, place);
  return facing > 0.0 ? inside.x * inside.y : 0.0;
}

// A pale room with a large lamp above and two narrow ones.
vec3 studio(vec3 d) {
  float height = max(d.y, 0.0);
  vec3 light = mix(vec3(0.30, 0.35, 0.41), vec3(0.86, 0.89, 0.92), exp(-2.6 * height));
  light += 1.5 * box(d, normalize(vec3(0.25, 1.0, 0.1)), normalize(vec3(1.0, -0.25, 0.0)), vec2(0.55, 0.38));
  light += 1.3 * box(d, normalize(vec3(-1.0, 0.55, 0.25)), normalize(vec3(0.25, 0.0, 1.0)), vec2(0.16, 0.5));
  light += 0.9 * box(d, normalize(vec3(0.5, 0.45, -1.0)), normalize(vec3(1.0, 0.0, 0.5)), vec2(0.55, 0.12));
  return light;
}

void main() {
  vec2 angles = (gl_FragCoord.xy / vec2(1024.0, 512.0) - 0.5) * vec2(6.2831853, 3.1415927);
  vec3 d = vec3(sin(angles.x) * cos(angles.y), sin(angles.y), cos(angles.x) * cos(angles.y));
  oLight = vec4(uSky ? sky(d) : studio(d), 1.0);
}
