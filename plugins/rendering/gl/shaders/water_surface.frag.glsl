in vec3 vNormal;
in vec3 vPosition;
layout(location = 0) out vec4 oNormal;

void main() {
  vec3 normal = normalize(vNormal);
  if (!gl_FrontFacing) normal = -normal;
  oNormal = vec4(0.5 + 0.5 * normal, 1.0);
}
