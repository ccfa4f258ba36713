#include "words.glsl"
#include "formulas.glsl"

uniform vec3 uColor;
uniform float uMaterial;
in vec3 vNormal;
in vec3 vPosition;
in vec3 vColor;
layout(location = 0) out vec4 oAlbedo;
layout(location = 1) out vec2 oNormal;

void main() {
  vec3 normal = normalize(vNormal);
  if (!gl_FrontFacing) normal = -normal;
  oAlbedo = vec4(uColor * vColor, uMaterial);
  oNormal = storedNormal(normal);
}
