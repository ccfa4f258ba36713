#include "grid.glsl"

layout(location = 0) in vec3 iPosition;
layout(location = 1) in vec3 iNormal;
uniform mat4 uToClip;
uniform mat3 uNormalToSun;
out vec3 vNormal;

void main() {
  vNormal = uNormalToSun * iNormal;
  gl_Position = onGrid(uToClip * vec4(iPosition, 1.0));
}
