// Light that meets the glass at a flat angle is reflected and refracted away: rims cast darker shadows.
uniform vec3 uTint;
in vec3 vNormal;
layout(location = 0) out vec4 oThrough;

void main() {
  float facing = abs(normalize(vNormal).z);
  oThrough = vec4(pow(uTint, vec3(0.1)) * mix(0.72, 0.96, facing * facing), 1.0);
}
